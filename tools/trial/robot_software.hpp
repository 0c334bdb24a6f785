// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

#include "common/bus/loop_bus.hpp"
#include "common/node/device_node.hpp"
#include "common/node/map_options.hpp"
#include "common/node/run.hpp"
#include "sim/devices/simulated_robot.hpp"
#include "tools/trial/params.hpp"
#include "tools/trial/record.hpp"
#include "tools/trial/robots.hpp"
#include "tools/trial/simulated_line.hpp"

namespace nodmap::trial {

/// One process of the robot: its node and its environment while it runs.
class Process {
 public:
  /// Starts it.
  Process(std::string name, bus::LoopNetwork& network, node::NodeFactory make_node);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool is_running() const { return running_ != nullptr; }
  /// The node; null while the process is not running.
  [[nodiscard]] node::Node* node() const { return running_ ? running_->node.get() : nullptr; }

  /// Lets a driver exchange bytes with its device; does nothing for other processes.
  void spin_once();

  void start();
  /// Like kill -9: the state is lost and nothing is written. A driver's lines must be cut first.
  void kill() { running_.reset(); }

  /// Message counts and the module's own metrics, without latencies, which depend on the wall
  /// clock.
  [[nodiscard]] nlohmann::json report() const;

 private:
  struct Running {
    explicit Running(bus::LoopNetwork& network) : bus(network), context{bus, counts, {}} {}

    bus::LoopBus bus;
    node::MessageCounts counts;
    node::Context context;
    std::unique_ptr<node::Node> node;
    node::DeviceNode* device_node = nullptr;
  };

  std::string name_;
  bus::LoopNetwork& network_;
  node::NodeFactory make_node_;
  std::unique_ptr<Running> running_;
};

/// The robot's software: the same nodes as on the real robot, all on one network, the drivers
/// connected to the simulated devices.
class RobotSoftware : private boost::noncopyable {
 public:
  /// Leaves out the processes named in `without`. `map`: for 2D SLAM.
  RobotSoftware(sim::SimulatedRobot& hardware, bus::LoopNetwork& network, AllParams params,
                Robot robot, std::set<std::string> without, node::MapOptions map);

  /// Lets lines and drivers do what is due at the hardware's time.
  void step();

  void kill(const std::string& name);
  void start(const std::string& name);

  /// Lets each process handle its remaining messages.
  void finish();
  /// Writes each module's files into a folder of its own.
  void write_results(const std::filesystem::path& dir) const;
  /// Process::report() by process.
  [[nodiscard]] nlohmann::json report() const;

 private:
  void add(const std::string& name, node::NodeFactory make_node);
  void add_scanner(Robot robot, const std::function<time::Moment()>& clock);
  /// Releases the robot, as a person does after each start of the base driver.
  void release_robot();
  [[nodiscard]] Process& process(const std::string& name);

  sim::SimulatedRobot& hardware_;
  bus::LoopNetwork& network_;
  bus::LoopBus person_;
  std::int64_t stop_seq_ = 0;
  AllParams params_;
  std::set<std::string> without_;
  node::MapOptions map_;
  SimulatedLine laser_line_;
  SimulatedLine servo_line_;
  SimulatedLine base_line_;
  std::vector<Process> processes_;  // destroyed before the lines
};

}  // namespace nodmap::trial
