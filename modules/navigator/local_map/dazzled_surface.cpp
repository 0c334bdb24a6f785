// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/dazzled_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nodmap::navigator {
namespace {

constexpr double kNothing = std::numeric_limits<double>::infinity();

// A reflector dazzles within 15 degrees of a right angle.
constexpr double kWidestRad = geometry::deg_to_rad(30.0);

// Whether a beam has no range, or one that is too short. A range beyond the longest one, such as
// +infinity, says that nothing is near.
bool is_unmeasured(const scan::Scan& scan, std::size_t beam) {
  return !(static_cast<double>(scan.ranges_m[beam]) >= scan.range_min_m);
}

double range_m(const scan::Scan& scan, std::size_t beam) {
  return beam < scan.ranges_m.size() && scan.is_hit(beam) ? static_cast<double>(scan.ranges_m[beam])
                                                          : kNothing;
}

}  // namespace

std::vector<std::optional<double>> dazzled_ranges(const scan::Scan& scan) {
  const std::size_t n = scan.ranges_m.size();
  std::vector<std::optional<double>> assumed_m(n);
  for (std::size_t first = 0; first < n; ++first) {
    if (!is_unmeasured(scan, first)) {
      continue;
    }
    std::size_t end = first + 1;
    while (end < n && is_unmeasured(scan, end)) {
      ++end;
    }
    const double before_m = first > 0 ? range_m(scan, first - 1) : kNothing;
    const double nearest_m = std::min(before_m, range_m(scan, end));
    const double width_rad = std::abs(scan.angle_step_rad) * static_cast<double>(end - first - 1);
    if (nearest_m < kNothing && width_rad < kWidestRad + 0.5 * std::abs(scan.angle_step_rad)) {
      std::fill(assumed_m.begin() + static_cast<std::ptrdiff_t>(first),
                assumed_m.begin() + static_cast<std::ptrdiff_t>(end), nearest_m);
    }
    first = end;
  }
  return assumed_m;
}

}  // namespace nodmap::navigator
