// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/behaviours/detour.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/angle.hpp"

namespace nodmap::navigator {
namespace {

// A detour ends only this much nearer to the goal than it began.
constexpr double kNearerM = 0.3;
// The farthest steering direction; a goal farther to the side is reached by an arc.
constexpr double kFarthestAside = geometry::deg_to_rad(65.0);
// A wall farther away is not followed.
constexpr double kWallM = 1.2;
// Free distance that suffices along a wall. With more the robot would keep so far off that it
// loses the wall.
constexpr double kAlongWallM = 0.5;

// The direction of the nearest obstacle on the wall's side; empty: there is no wall.
std::optional<double> wall_direction(const Points& points_base, Side side) {
  double nearest_m = kWallM;
  std::optional<double> direction_rad;
  for (const Eigen::Vector2d& p : points_base) {
    const double to_wall_side_rad = -sign(side) * std::atan2(p.y(), p.x());
    const bool on_wall_side = to_wall_side_rad > geometry::deg_to_rad(-30.0) &&
                              to_wall_side_rad < geometry::deg_to_rad(150.0);
    if (on_wall_side && p.norm() < nearest_m) {
      nearest_m = p.norm();
      direction_rad = -sign(side) * to_wall_side_rad;
    }
  }
  return direction_rad;
}

}  // namespace

void Detour::begin(Side side, const GoalInBase& goal) {
  if (side_ == Side::kNone) {
    began_at_m_ = goal.distance_m();
    side_ = side;
  }
}

std::optional<double> Detour::direction(const FreeSpace& space, const Points& points_base,
                                        const GoalInBase& goal, double needed_m) {
  const double straight_rad = std::clamp(goal.bearing_rad(), -kFarthestAside, kFarthestAside);
  // Obstacles beyond the goal do not block the path to it.
  const double to_goal_m = std::min(needed_m, goal.distance_m());
  const bool is_free = space.at(FreeSpace::degree_of(straight_rad)) >= to_goal_m;
  if (side_ == Side::kNone) {
    return is_free ? straight_rad : round_obstacle(space, goal, straight_rad, to_goal_m);
  }
  const auto wall_rad = wall_direction(points_base, side_);
  const bool is_ahead = straight_rad == goal.bearing_rad();
  const bool is_nearer = goal.distance_m() < began_at_m_ - kNearerM;
  if (!wall_rad || (is_free && is_ahead && is_nearer)) {
    end();
    return is_free ? straight_rad : round_obstacle(space, goal, straight_rad, to_goal_m);
  }
  // Along the wall, and near it: the first free direction from the wall on.
  const FreeNeighbours near =
      free_neighbours(space, std::clamp(*wall_rad, -kFarthestAside, kFarthestAside),
                      std::min(needed_m, kAlongWallM));
  // No free direction on that side, as in a corner: then on the other.
  const bool left = near.left_rad && (side_ == Side::kLeft || !near.right_rad);
  return left ? near.left_rad : near.right_rad;
}

std::optional<double> Detour::round_obstacle(const FreeSpace& space, const GoalInBase& goal,
                                             double straight_rad, double needed_m) {
  const FreeNeighbours near = free_neighbours(space, straight_rad, needed_m);
  if (!near.left_rad && !near.right_rad) {
    return std::nullopt;
  }
  const bool left = !near.right_rad || (near.left_rad && *near.left_rad - straight_rad <=
                                                             straight_rad - *near.right_rad);
  begin(left ? Side::kLeft : Side::kRight, goal);
  return left ? near.left_rad : near.right_rad;
}

}  // namespace nodmap::navigator
