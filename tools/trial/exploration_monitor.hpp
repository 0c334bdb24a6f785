// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/loop_bus.hpp"
#include "nodmap/grid_chunk_t.hpp"
#include "sim/body/robot_model.hpp"
#include "sim/world/world.hpp"

namespace nodmap::trial {

/// The fraction seen at one moment.
struct SeenSample {
  time::SteadyTime instant{};
  double ratio = 0.0;  ///< fraction of the seeable floor that is free in MAP_2D
};

/// The record of an exploration.
struct ExplorationRecord {
  std::vector<SeenSample> seen;          ///< at each revision of MAP_2D
  std::optional<time::SteadyTime> home;  ///< when the explorer reported that it is home
};

/// Compares MAP_2D with the true floor, and records the explorer's reports.
class ExplorationMonitor {
 public:
  ExplorationMonitor(const sim::World& world, const sim::RobotModel& model,
                     const sim::BodyParams& body, bus::LoopNetwork& network);

  [[nodiscard]] const ExplorationRecord& record() const { return record_; }

 private:
  void on_map(const nodmap::grid_chunk_t& message);

  const sim::RobotModel& model_;
  bus::LoopBus bus_;
  std::vector<Eigen::Vector2d> floor_map_;
  std::vector<bool> is_seen_;
  ExplorationRecord record_;
};

}  // namespace nodmap::trial
