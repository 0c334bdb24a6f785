// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/possible_ramp.hpp"

#include <algorithm>

#include "common/geometry/whole_steps.hpp"

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

// A sill is as low as the foot of a ramp; but behind it nothing rises.
bool PossibleRamp::could_be(const Eigen::Vector2d& p_odom, std::int16_t high_cm,
                            double tolerance_m) const {
  constexpr double kHighestSillM = 0.25;
  const double top_odom_m = 0.01 * high_cm;
  const double height_m = top_odom_m - ground_.height_m(p_odom);
  return could_lead_up({p_odom.x(), p_odom.y(), top_odom_m}, height_m, tolerance_m) &&
         (height_m > kHighestSillM || rises_behind(p_odom, high_cm));
}

// Whether obstacles 0.3 to 1 m behind a place are higher than `high_cm`, by 3 cm at least, and
// there is no floor on the way.
bool PossibleRamp::rises_behind(const Eigen::Vector2d& p_odom, std::int16_t high_cm) const {
  constexpr double kNearestM = 0.3;
  constexpr double kFarthestM = 1.0;
  constexpr int kRiseCm = 3;
  const Eigen::Vector2d step = grid_.cell_size_m() * (p_odom - robot_odom_).normalized();
  const Eigen::Vector2d aside(-step.y(), step.x());
  const int farthest = geometry::whole_steps(kFarthestM, grid_.cell_size_m());
  const int nearest = geometry::whole_steps(kNearestM, grid_.cell_size_m());
  for (int i = 1; i < farthest; ++i) {
    for (const double side : {-1.0, 0.0, 1.0}) {
      const LocalCell* cell = grid_.find(Eigen::Vector2d(p_odom + i * step + side * aside));
      if (cell == nullptr || cell->is_floor) {
        return false;
      }
      if (i >= nearest && cell->is_obstacle() && cell->high_cm >= high_cm + kRiseCm) {
        return true;
      }
    }
  }
  return false;
}

bool PossibleRamp::leads_down(const Eigen::Vector3d& p_odom, const Eigen::Vector2d& crossing_odom,
                              const Plane& plane, double tolerance_m) const {
  constexpr double kFarthestM = 0.6;  // two lines on the floor at 2 m
  const Eigen::Vector2d floor_odom = last_floor_before(crossing_odom, kFarthestM);
  const double floor_m =
      ground_.is_known(floor_odom) ? ground_.height_m(floor_odom) : plane.at(floor_odom);
  return p_odom.z() >
         floor_m - tolerance_m - ground_.max_slope() * (p_odom.head<2>() - floor_odom).norm();
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
