// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/mixed_pixel.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace nodmap::navigator {
namespace {

// Surfaces are at least this far apart: six standard deviations of a range, and almost three of
// one that is extrapolated from two others.
constexpr double kJumpM = 0.06;
// Two beams on a plane that passes this near the sensor look along it. The spot, 1 to 2 cm wide at
// the sensor, is wider than the part of the plane that they see.
constexpr double kSpotM = 0.04;

// The range of the beam this many places beside another one; empty if there is no such beam, or if
// nothing came back.
std::optional<double> range_beside(const scan::Scan& scan, std::size_t beam, int places) {
  const auto index = static_cast<std::ptrdiff_t>(beam) + places;
  if (index < 0 || index >= std::ssize(scan.ranges_m) ||
      !scan.is_hit(static_cast<std::size_t>(index))) {
    return std::nullopt;
  }
  return static_cast<double>(scan.ranges_m[static_cast<std::size_t>(index)]);
}

// The distance from the sensor to the plane through the ends of two beams side by side. Along a
// plane the inverse range is cos(angle) / distance.
double distance_of_plane_m(const scan::Scan& scan, double next_m, double second_m) {
  const double slope = (1.0 / next_m - 1.0 / second_m) / scan.angle_step_rad;
  return 1.0 / std::hypot(1.0 / next_m, slope);
}

// Whether a beam ends on the plane through the ends of the two beams beside it on one side. Along
// a plane the inverse range is linear in the angle, to 2 % within 10 degrees. The beam may be off
// by the noise, and by half a step to its neighbour: beams that graze a plane are far apart on it.
bool continues(const scan::Scan& scan, std::size_t beam, int side) {
  const auto next_m = range_beside(scan, beam, side);
  const auto second_m = range_beside(scan, beam, 2 * side);
  if (!next_m || !second_m || distance_of_plane_m(scan, *next_m, *second_m) < kSpotM) {
    return false;
  }
  const auto here_m = static_cast<double>(scan.ranges_m[beam]);
  const double inverse = 2.0 / *next_m - 1.0 / *second_m;
  const double tolerance_m = std::max(kJumpM, 0.5 * std::abs(*next_m - here_m));
  return inverse > 0.0 && std::abs(1.0 / inverse - here_m) < tolerance_m;
}

}  // namespace

bool is_mixed_pixel(const scan::Scan& scan, std::size_t beam) {
  const auto here_m = range_beside(scan, beam, 0);
  const auto before_m = range_beside(scan, beam, -1);
  const auto after_m = range_beside(scan, beam, 1);
  if (!here_m || !before_m || !after_m) {
    return false;
  }
  const auto [near_m, far_m] = std::minmax(*before_m, *after_m);
  const bool is_between = *here_m > near_m + kJumpM && *here_m < far_m - kJumpM;
  return is_between && !continues(scan, beam, -1) && !continues(scan, beam, 1);
}

}  // namespace nodmap::navigator
