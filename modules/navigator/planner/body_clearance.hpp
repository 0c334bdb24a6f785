// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/robot/footprint.hpp"
#include "modules/navigator/obstacle_points.hpp"
#include "modules/navigator/planner/distance_field.hpp"

namespace nodmap::navigator {

/// The distance from the body, at any pose near the robot, to the nearest obstacle. It is read from
/// a field of distances at discs that cover the body and, where that gives little, measured to the
/// points themselves.
class BodyClearance {
 public:
  explicit BodyClearance(const robot::Footprint& body);

  /// Sets the obstacles, in base. Only those within 2.5 m count, and none that are inside the body.
  void measure(const Points& points_base);

  /// Distance from the body at a pose (in base, now) to the nearest obstacle, metres; negative
  /// inside. Exact below 6 cm if the pose is within 0.5 m; otherwise it may be off by 3.5 cm.
  [[nodiscard]] double at(const geometry::SE2& pose_base) const;

 private:
  struct Disc {
    Eigen::Vector2d center;
    double radius_m = 0.0;
  };

  [[nodiscard]] double by_cells_m(const geometry::SE2& pose_base) const;

  robot::Footprint body_;
  std::vector<Disc> discs_;  // they cover the body
  DistanceField obstacles_;
  Points near_points_base_;  // the obstacles that a slow motion can come near
};

}  // namespace nodmap::navigator
