// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <boost/core/noncopyable.hpp>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace nodmap::bench {

/// The whole robot as processes, on the simulator's devices. Whatever still runs at the end is
/// killed.
class RobotProcesses : private boost::noncopyable {
 public:
  struct Options {
    std::filesystem::path bin;    ///< where the programs are
    std::filesystem::path world;  ///< WORLD.yaml
    std::filesystem::path out;    ///< a new folder for logs and links
    std::vector<std::string> faults;
  };

  /// Starts the simulator and, once its links are there, everything else; releases the robot.
  explicit RobotProcesses(Options options);
  ~RobotProcesses();

  void start(const std::string& name);
  void kill(const std::string& name);
  /// Lets the robot drive, which it does not after each start of the base driver ("kurt").
  void release();

  /// The names of those that have ended by themselves since the last call.
  [[nodiscard]] std::vector<std::string> take_dead();

  /// SIGINT to all, the simulator last. The names of those that did not end with 0 within ten
  /// seconds.
  [[nodiscard]] std::vector<std::string> stop();

  [[nodiscard]] const std::map<std::string, pid_t>& pids() const { return pids_; }

 private:
  [[nodiscard]] std::vector<std::string> command(const std::string& name) const;
  [[nodiscard]] bool ends_well(const std::string& name);

  Options options_;
  std::map<std::string, pid_t> pids_;
};

}  // namespace nodmap::bench
