// SPDX-License-Identifier: BSD-3-Clause
#include "common/scan/ego_map_points.hpp"

#include <cmath>
#include <cstddef>
#include <limits>

namespace nodmap::scan {
namespace {

// Tolerance: distance and point are 32-bit copies of the same numbers.
bool fits(double distance_m, const Eigen::Vector2d& p) {
  return std::isfinite(distance_m) && distance_m >= 0.0 && p.allFinite() &&
         std::abs(p.norm() - distance_m) <= 1e-3 * (1.0 + distance_m);
}

}  // namespace

std::optional<std::vector<Eigen::Vector2d>> read_ego_map_points(std::span<const float> distance_m,
                                                                std::span<const float> x_m,
                                                                std::span<const float> y_m) {
  if (distance_m.empty() || x_m.size() != distance_m.size() || y_m.size() != distance_m.size()) {
    return std::nullopt;
  }
  std::vector<Eigen::Vector2d> points;
  points.reserve(distance_m.size());
  for (std::size_t i = 0; i < distance_m.size(); ++i) {
    if (distance_m[i] == std::numeric_limits<float>::infinity()) {
      continue;
    }
    const Eigen::Vector2d p(static_cast<double>(x_m[i]), static_cast<double>(y_m[i]));
    if (!fits(static_cast<double>(distance_m[i]), p)) {
      return std::nullopt;
    }
    points.push_back(p);
  }
  return points;
}

}  // namespace nodmap::scan
