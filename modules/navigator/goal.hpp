// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "common/geometry/se2.hpp"
#include "modules/navigator/free_space.hpp"

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
  double bearing_rad = 0.0;  ///< positive left
  double distance_m = 0.0;
  double tolerance_m = 0.0;
  Eigen::Vector2d p_base = Eigen::Vector2d::Zero();
  /// The heading of a goal at which the robot docks.
  struct Heading {
    double yaw_rad = 0.0;  ///< of the goal in base
    double tolerance_rad = 0.0;
  };
  std::optional<Heading> heading;
};

[[nodiscard]] GoalInBase goal_in_base(const Eigen::Vector2d& p_goal_base, double tolerance_m);

/// Whether the robot is at the goal. Once it is there it stays so up to 10 cm farther away, so that
/// it does not start and stop at the border of the tolerance.
[[nodiscard]] bool has_arrived(const GoalInBase& goal, bool had_arrived);

/// Leads around an obstacle between robot and goal (after Bug2, Lumelsky and Stepanov 1987): along
/// the wall, on the side first chosen, until the direction to the goal is free and the goal is
/// nearer than where the detour began. Without this memory the robot would leave a dead end and
/// drive into it again.
class Detour {
 public:
  /// The direction to steer to, in base; empty if no direction ahead is free for `needed_m`.
  [[nodiscard]] std::optional<double> direction(const FreeSpace& space, const Points& points_base,
                                                const GoalInBase& goal, double needed_m);

  /// The side of the detour: +1 left, -1 right, 0 none.
  [[nodiscard]] double side() const { return side_; }
  /// Begins a detour, because the robot had to turn to this side, away from an obstacle.
  void begin(double side, const GoalInBase& goal);
  void end() { side_ = 0.0; }

 private:
  [[nodiscard]] std::optional<double> round_obstacle(const FreeSpace& space, const GoalInBase& goal,
                                                     double straight_rad, double needed_m);

  double side_ = 0.0;
  double began_at_m_ = 0.0;  // distance to the goal
};

}  // namespace nodmap::navigator
