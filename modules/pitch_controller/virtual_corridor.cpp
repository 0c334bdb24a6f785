// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/virtual_corridor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nodmap::pitch_controller {
namespace {

// Smallest distance, used where the front is at the axis or behind it: any steep pitch covers it,
// and there is no division by zero.
constexpr double kNearestM = 0.05;
constexpr int kRevisitIterations = 12;
constexpr double kSteepestRad = geometry::deg_to_rad(89.9);

// The distance beyond which a line at `angle_rad` to the horizontal is at least `height_m` above
// or below the axis.
double reaches_from_m(double height_m, double angle_rad) {
  if (height_m <= 0.0) {
    return angle_rad >= 0.0 ? 0.0 : std::numeric_limits<double>::infinity();
  }
  if (angle_rad <= 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  return height_m / std::tan(std::min(angle_rad, kSteepestRad));
}

}  // namespace

VirtualCorridor VirtualCorridor::of(const robot::RobotParams& robot) {
  return {robot.corridor_bottom_m(), robot.corridor_top_m(), robot.mount.z_m,
          0.5 * robot.body.length_m - robot.mount.x_m};
}

double VirtualCorridor::from_axis_m(double distance_m) const {
  return std::max(distance_m + axis_behind_front_m, kNearestM);
}

PitchInterval VirtualCorridor::area_from(double distance_m) const {
  const double z = from_axis_m(distance_m);
  return {-std::atan((axis_height_m - bottom_m) / z), std::atan((top_m - axis_height_m) / z)};
}

double VirtualCorridor::covered_from_m(const PitchInterval& area) const {
  const double low = reaches_from_m(axis_height_m - bottom_m, -area.min_rad);
  const double high = reaches_from_m(top_m - axis_height_m, area.max_rad);
  return std::max(std::max(low, high) - axis_behind_front_m, 0.0);
}

double VirtualCorridor::met_from_m(double covered_from_m, double obstacle_m) const {
  const double below_m = axis_height_m - bottom_m;
  const double above_m = top_m - axis_height_m;
  const double share = std::max(below_m > 0.0 ? 1.0 - obstacle_m / below_m : 0.0,
                                above_m > 0.0 ? 1.0 - obstacle_m / above_m : 0.0);
  return std::max(0.0, share) * from_axis_m(covered_from_m) - axis_behind_front_m;
}

PitchInterval area_of_interest(double forward_mps, double fast_mps,
                               const PitchInterval& corridor_area, const PitchInterval& mechanics) {
  const double slowness = std::clamp(1.0 - forward_mps / fast_mps, 0.0, 1.0);
  const double surplus = slowness * slowness;
  const double min_rad = std::max(corridor_area.min_rad, mechanics.min_rad);
  const double max_rad = std::min(corridor_area.max_rad, mechanics.max_rad);
  return {min_rad + surplus * (mechanics.min_rad - min_rad),
          max_rad + surplus * (mechanics.max_rad - max_rad)};
}

double revisit_s(const VirtualCorridor& corridor, const NodMotion& nod, double from_m,
                 double forward_mps) {
  const PitchInterval before = corridor.area_from(from_m);
  double time_s = 0.0;
  // The nearer the obstacle, the nearer to the end of the sweep it is seen: the time rises to its
  // fixed point from below.
  for (int i = 0; i < kRevisitIterations; ++i) {
    const PitchInterval after = corridor.area_from(std::max(0.0, from_m - forward_mps * time_s));
    const double above_rad = 2.0 * nod.ends.max_rad - before.min_rad - after.min_rad;
    const double below_rad = before.max_rad + after.max_rad - 2.0 * nod.ends.min_rad;
    time_s = nod.reversal_s + std::max(above_rad, below_rad) / nod.rate_rad_s;
  }
  return time_s;
}

ClearView clear_view(const VirtualCorridor& corridor, const PitchInterval& seen,
                     double line_spacing_rad, double obstacle_m, double look_ahead_m) {
  // On an upright surface at distance d neighbouring lines are dp (d^2 + h^2) / d apart. This
  // equals the height o of the obstacle at
  //   d = (o -+ sqrt(o^2 - 4 dp^2 h^2)) / 2 dp, and is less in between.
  const double spacing_at_axis_height_m = 2.0 * line_spacing_rad * corridor.axis_height_m;
  const double root_sq =
      obstacle_m * obstacle_m - spacing_at_axis_height_m * spacing_at_axis_height_m;
  if (root_sq < 0.0 || !(line_spacing_rad > 0.0)) {
    return {};
  }
  const double root = std::sqrt(root_sq);
  const double dense_from_m =
      0.5 * (obstacle_m - root) / line_spacing_rad - corridor.axis_behind_front_m;
  const double dense_until_m =
      0.5 * (obstacle_m + root) / line_spacing_rad - corridor.axis_behind_front_m;
  // The outermost line may lie anywhere up to one spacing within the end of the sweep.
  const PitchInterval lines{seen.min_rad + line_spacing_rad, seen.max_rad - line_spacing_rad};
  return {std::max(corridor.covered_from_m(lines), dense_from_m),
          std::min(dense_until_m, look_ahead_m)};
}

}  // namespace nodmap::pitch_controller
