// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/dazzled_surface.hpp"

#include <algorithm>
#include <limits>

namespace nodmap::navigator {
namespace {

constexpr double kNothing = std::numeric_limits<double>::infinity();

bool is_unmeasured(const scan::Scan& scan, std::size_t beam) {
  return !scan.is_hit(beam) && scan.ranges_m[beam] != std::numeric_limits<float>::infinity();
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
    if (nearest_m < kNothing) {
      std::fill(assumed_m.begin() + static_cast<std::ptrdiff_t>(first),
                assumed_m.begin() + static_cast<std::ptrdiff_t>(end), nearest_m);
    }
    first = end;
  }
  return assumed_m;
}

}  // namespace nodmap::navigator
