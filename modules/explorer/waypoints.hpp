// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "modules/explorer/planning_grid.hpp"
#include "modules/explorer/viewpoints.hpp"

namespace nodmap::explorer {

/// A goal for the navigator, in map.
struct Goal {
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
  double tolerance_m = 0.0;
};

/// Whether the robot can drive straight from one place to another. At first it may be nearer to an
/// obstacle than a path may, because it is already there.
[[nodiscard]] bool is_line_passable(const PlanningGrid& grid, const Eigen::Vector2d& from_map,
                                    const Eigen::Vector2d& to_map);

/// The number of viewpoints, from the tour's first on, that the robot passes in their order within
/// `tolerance_m` on a passable straight line to the last of them; at least 1. The robot need not
/// stop at the others.
[[nodiscard]] std::size_t num_on_line(const PlanningGrid& grid, const std::vector<Viewpoint>& tour,
                                      const Eigen::Vector2d& from_map, double tolerance_m);

/// Leads the navigator along a path, from waypoint to waypoint without stops. The navigator knows
/// only the ground that it has seen itself. If it is led around corners, it need not guess what is
/// behind walls.
class Waypoints {
 public:
  explicit Waypoints(double tolerance_m) : tolerance_m_(tolerance_m) {}

  void clear() { waypoint_map_.reset(); }

  /// The last point of the path to which a straight line is passable, but at least the end of the
  /// part of the path around the robot. Each new goal costs the navigator time, so the last one is
  /// kept while it is ahead on the path. `last_tolerance_m`: tolerance at the end of the path.
  [[nodiscard]] Goal next(const PlanningGrid& grid, const std::vector<Eigen::Vector2d>& path_map,
                          const Eigen::Vector2d& p_map, double last_tolerance_m);

 private:
  double tolerance_m_;
  std::optional<Eigen::Vector2d> waypoint_map_;
};

}  // namespace nodmap::explorer
