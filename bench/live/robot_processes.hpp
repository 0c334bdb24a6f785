// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <boost/core/noncopyable.hpp>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace nodmap::bench {

/// The whole robot as processes, with simulated devices and the priorities of procman/sim.pmd. The
/// destructor kills what still runs.
class RobotProcesses : private boost::noncopyable {
 public:
  struct Options {
    std::filesystem::path bin;    ///< folder of the programs
    std::filesystem::path world;  ///< WORLD.yaml
    std::filesystem::path out;    ///< new folder for logs and links
    std::vector<std::string> faults;
  };

  /// Starts the simulator, waits for its device links, starts the other processes and releases the
  /// robot.
  explicit RobotProcesses(Options options);
  ~RobotProcesses();

  void start(const std::string& name);
  void kill(const std::string& name);
  /// Releases the robot, which is stopped after each start of the base driver ("kurt").
  void release();

  /// The names of the processes that have ended by themselves since the last call.
  [[nodiscard]] std::vector<std::string> take_dead();

  /// Sends SIGINT to all processes, to the simulator last. Returns the names of those that did not
  /// exit with 0 within ten seconds.
  [[nodiscard]] std::vector<std::string> stop();

  [[nodiscard]] const std::map<std::string, pid_t>& pids() const { return pids_; }

 private:
  [[nodiscard]] std::vector<std::string> command(const std::string& name) const;
  [[nodiscard]] bool ends_well(const std::string& name);

  Options options_;
  std::map<std::string, int> realtime_;  ///< real-time priority of each process; 0: none
  std::map<std::string, pid_t> pids_;
};

}  // namespace nodmap::bench
