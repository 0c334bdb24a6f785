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

/// The floor of a world that can be seen from its start: cells of 5 cm, connected with the start,
/// at least 10 cm from everything that the robot's body would touch. Nearer to walls it is chance
/// whether a beam meets a cell. Middles of the cells in map, metres.
[[nodiscard]] std::vector<Eigen::Vector2d> seeable_floor_map(const sim::World& world,
                                                             const sim::BodyParams& body);

/// How much had been seen at a moment.
struct SeenSample {
  time::SteadyTime instant{};
  double ratio = 0.0;  ///< of the seeable floor, free in MAP_2D
};

/// What became of an exploration.
struct ExplorationRecord {
  std::vector<SeenSample> seen;          ///< at each revision of MAP_2D
  std::optional<time::SteadyTime> home;  ///< when the explorer said that it is home
};

/// Compares MAP_2D with the true floor, and hears what the explorer says.
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
