// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/extended_scan.hpp"

#include <utility>

namespace nodmap::map_server {

ExtendedScan::ExtendedScan(const AngleBins& bins, Relevance relevance)
    : bins_(bins), relevance_(relevance) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  dummy_.distance_m = relevance == Relevance::kNearest ? kInfinity : -kInfinity;
  points_.assign(bins_.size(), dummy_);
  moved_ = points_;
}

void ExtendedScan::transform(const geometry::SE2& T_now_last) {
  const Eigen::Matrix2d R = T_now_last.rotation();
  const Eigen::Vector2d t = T_now_last.translation();
  moved_.assign(moved_.size(), dummy_);
  for (EgoPoint& point : points_) {
    if (!point.valid) {
      continue;
    }
    point.move_to(R * point.p_base + t);
    const auto bin = bins_.index(point.bearing_rad);
    if (bin && std::isfinite(point.distance_m) &&
        prefers(point.distance_m, moved_[*bin].distance_m)) {
      moved_[*bin] = point;
    }
  }
  std::swap(points_, moved_);
}

}  // namespace nodmap::map_server
