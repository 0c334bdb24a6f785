// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "modules/explorer/params.hpp"
#include "modules/explorer/planning_grid.hpp"

namespace nodmap::explorer {

/// Predicts the unknown cells that the laser would show from a place.
class RayCaster {
 public:
  /// `sensor_ahead_m`: position of the laser ahead of base.
  RayCaster(const ViewParams& params, double sensor_ahead_m)
      : params_(params), sensor_ahead_m_(sensor_ahead_m) {}

  /// The unknown cells that a robot at `p_map` with heading `heading_rad` would see, found by ray
  /// casting; each once, as indices of grid.ground().
  [[nodiscard]] const std::vector<std::uint32_t>& unknown_cells(const PlanningGrid& grid,
                                                                const Eigen::Vector2d& p_map,
                                                                double heading_rad);

 private:
  void cast(const PlanningGrid& grid, const Eigen::Vector2d& from_map, double angle_rad);

  ViewParams params_;
  double sensor_ahead_m_;
  std::vector<std::uint32_t> cells_;
  Marks counted_;  // the cells in cells_
};

}  // namespace nodmap::explorer
