// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/possible_ramp.hpp"

#include <algorithm>

namespace nodmap::navigator {

bool PossibleRamp::could_lead_up(const Eigen::Vector3d& p_odom, double height_m,
                                 double tolerance_m) const {
  const Eigen::Vector2d p = p_odom.head<2>();
  const double distance_m = (p - robot_odom_).norm();
  if (distance_m < params_.ground.doubt_from_m || grid_.find(p) == nullptr) {
    return false;
  }
  // A ramp that is this high there has begun here at the latest.
  const double ramp_m = height_m / ground_.max_slope() + grid_.cell_size_m();
  const Eigen::Vector2d floor_odom = last_floor_before(p, std::min(ramp_m, distance_m));
  // What counts as floor may be higher by the tolerance, and the point by as much again.
  return p_odom.z() < ground_.height_m(floor_odom) + 2.0 * tolerance_m +
                          ground_.max_slope() * (p - floor_odom).norm();
}

bool PossibleRamp::leads_down(const Eigen::Vector3d& p_odom,
                              const Eigen::Vector2d& crossing_odom) const {
  constexpr double kFarthestM = 0.6;  // two lines on the floor at 2 m
  const Eigen::Vector2d floor_odom = last_floor_before(crossing_odom, kFarthestM);
  return p_odom.z() > ground_.height_m(floor_odom) - params_.floor_tolerance_m -
                          ground_.max_slope() * (p_odom.head<2>() - floor_odom).norm();
}

// The nearest place with seen floor between a place and the robot. If there is none within
// `farthest_m`, the point at that distance.
Eigen::Vector2d PossibleRamp::last_floor_before(const Eigen::Vector2d& p_odom,
                                                double farthest_m) const {
  const Eigen::Vector2d back = robot_odom_ - p_odom;
  const Eigen::Vector2d step = grid_.cell_size_m() / std::max(1e-3, back.norm()) * back;
  Eigen::Vector2d floor_odom = p_odom;
  for (double s = 0.0; s < std::min(farthest_m, back.norm()); s += grid_.cell_size_m()) {
    const LocalCell* cell = grid_.find(floor_odom);
    if (cell != nullptr && cell->is_floor) {
      break;
    }
    floor_odom += step;
  }
  return floor_odom;
}

}  // namespace nodmap::navigator
