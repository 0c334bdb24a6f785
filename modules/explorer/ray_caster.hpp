// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "modules/explorer/params.hpp"
#include "modules/explorer/planning_grid.hpp"

namespace nodmap::explorer {

/// What the laser would show from a place that the map does not.
class RayCaster {
 public:
  /// `sensor_ahead_m`: the laser in base, forward.
  RayCaster(const ViewParams& params, double sensor_ahead_m)
      : params_(params), sensor_ahead_m_(sensor_ahead_m) {}

  /// The unknown cells that would be seen by a robot at `p_map` that looks to `heading_rad`, each
  /// once, by their index in grid.ground(); found by ray casting.
  [[nodiscard]] const std::vector<std::uint32_t>& unknown_cells(const PlanningGrid& grid,
                                                                const Eigen::Vector2d& p_map,
                                                                double heading_rad);

 private:
  void cast(const PlanningGrid& grid, const Eigen::Vector2d& from_map, double angle_rad);

  ViewParams params_;
  double sensor_ahead_m_;
  std::vector<std::uint32_t> cells_;
  std::vector<std::uint32_t> counted_in_;  // the view in which a cell was counted last
  std::uint32_t num_casts_ = 0;
};

}  // namespace nodmap::explorer
