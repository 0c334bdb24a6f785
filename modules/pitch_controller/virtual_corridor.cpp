// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/virtual_corridor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nodmap::pitch_controller {
namespace {

// Where the front is at the axis or behind it: near enough to be covered by any steep pitch, and no
// division by zero.
constexpr double kNearestM = 0.05;
constexpr double kSteepestRad = geometry::deg_to_rad(89.9);

/// From where on a line `angle_rad` off the horizontal is at least `height_m` off the axis.
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

VirtualCorridor VirtualCorridor::of(const PitchControllerParams& params) {
  return {params.robot.corridor_bottom_m(), params.robot.corridor_top_m(), params.robot.mount.z_m,
          0.5 * params.robot.body.length_m - params.robot.mount.x_m};
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

}  // namespace nodmap::pitch_controller
