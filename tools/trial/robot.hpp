// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

#include "common/bus/loop_bus.hpp"
#include "sim/robot.hpp"
#include "tools/trial/epoch.hpp"
#include "tools/trial/params.hpp"
#include "tools/trial/process.hpp"
#include "tools/trial/simulated_line.hpp"

namespace nodmap::trial {

/// The robot's software: all its processes on one network, the drivers among them on lines to the
/// simulated devices. The very parts that drive the real robot.
class Robot {
 public:
  /// Without the processes named in `without`.
  Robot(sim::Robot& hardware, bus::LoopNetwork& network, AllParams params,
        std::set<std::string> without);
  ~Robot() = default;
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;
  Robot(Robot&&) = delete;
  Robot& operator=(Robot&&) = delete;

  /// Lines and drivers do what is due at the hardware's time.
  void step();

  void kill(const std::string& name);
  void start(const std::string& name);

  /// The end of the trial: each process works off what it still holds.
  void finish();
  /// Each module's files in a folder of its own.
  void write_results(const std::filesystem::path& dir) const;
  /// By process.
  [[nodiscard]] nlohmann::json report() const;

 private:
  void add(const std::string& name, node::NodeFactory make_node);
  [[nodiscard]] Process& process(const std::string& name);

  sim::Robot& hardware_;
  bus::LoopNetwork& network_;
  AllParams params_;
  std::set<std::string> without_;
  SimulatedLine laser_line_;
  SimulatedLine servo_line_;
  SimulatedLine base_line_;
  std::vector<Process> processes_;  // ends before what they hold
};

}  // namespace nodmap::trial
