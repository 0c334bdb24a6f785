// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/extended_scan.hpp"

#include <utility>

namespace nodmap::map_server {
namespace {

// Applies Eq. 2 to single points, to their cartesian and polar coordinates.
class Motion {
 public:
  explicit Motion(const geometry::SE2& T_now_last)
      : R_(T_now_last.rotation()), t_(T_now_last.translation()), yaw_rad_(T_now_last.yaw) {}

  void apply(EgoPoint& point) const {
    const Eigen::Vector2d rotated = R_ * point.p_base;
    const Eigen::Vector2d p = rotated + t_;
    // The bearing changes by the yaw and by the small angle between `rotated` and `p`. The series
    // of that angle's arctangent costs a fifth of an atan2, which would take half of a map update.
    const double along = rotated.dot(p);
    const double ratio = (rotated.x() * t_.y() - rotated.y() * t_.x()) / along;
    if (along > 0.0 && std::abs(ratio) < kSmall) {
      const double square = ratio * ratio;
      const double bearing =
          point.bearing_rad + yaw_rad_ + ratio * (1.0 - square * (1.0 / 3.0 - square / 5.0));
      point.bearing_rad =
          std::abs(bearing) <= geometry::kPi ? bearing : geometry::normalize_angle(bearing);
      point.p_base = p;
      point.distance_m = p.norm();
    } else {
      point.move_to(p);
    }
  }

 private:
  static constexpr double kSmall = 0.02;  // error of the series up to here: kSmall^7 / 7 = 2e-13

  Eigen::Matrix2d R_;
  Eigen::Vector2d t_;
  double yaw_rad_;
};

}  // namespace

ExtendedScan::ExtendedScan(const AngleBins& bins, Relevance relevance)
    : bins_(bins), relevance_(relevance) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  dummy_.distance_m = relevance == Relevance::kNearest ? kInfinity : -kInfinity;
  points_.assign(bins_.size(), dummy_);
  moved_ = points_;
}

void ExtendedScan::transform(const geometry::SE2& T_now_last) {
  const Motion motion(T_now_last);
  moved_.assign(moved_.size(), dummy_);
  for (EgoPoint& point : points_) {
    if (!point.valid) {
      continue;
    }
    motion.apply(point);
    const auto bin = bins_.index(point.bearing_rad);
    if (bin && std::isfinite(point.distance_m) &&
        prefers(point.distance_m, moved_[*bin].distance_m)) {
      moved_[*bin] = point;
    }
  }
  std::swap(points_, moved_);
}

}  // namespace nodmap::map_server
