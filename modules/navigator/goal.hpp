// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "common/geometry/se2.hpp"

namespace nodmap::navigator {

/// The goal of a GOAL message.
struct GoalInMap {
  geometry::SE2 T_map_goal;  ///< its yaw is used only with a heading tolerance
  double tolerance_m = 0.0;
  std::optional<double> heading_tolerance_rad;
  std::int64_t utime = 0;  ///< of the GOAL message, by which others recognise their goal
};

/// The goal as seen from the robot.
struct GoalInBase {
  Eigen::Vector2d p_base = Eigen::Vector2d::Zero();
  double tolerance_m = 0.0;
  /// The heading of a goal at which the robot docks.
  struct Heading {
    double yaw_rad = 0.0;  ///< of the goal in base
    double tolerance_rad = 0.0;
  };
  std::optional<Heading> heading = std::nullopt;

  [[nodiscard]] double distance_m() const { return p_base.norm(); }
  /// How far ahead a robot within the tolerance leaves it again.
  [[nodiscard]] double exit_distance_m() const {
    return p_base.x() +
           std::sqrt(std::max(0.0, tolerance_m * tolerance_m - p_base.y() * p_base.y()));
  }
  /// Positive left.
  [[nodiscard]] double bearing_rad() const { return std::atan2(p_base.y(), p_base.x()); }
};

/// Whether the robot is at the goal. Once it is there it stays so up to 10 cm farther away, so that
/// it does not start and stop at the border of the tolerance.
[[nodiscard]] bool has_arrived(const GoalInBase& goal, bool had_arrived);

}  // namespace nodmap::navigator
