// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/motion_detector.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::navigator {
namespace {

/// Nothing farther is looked for: there a person has five beams.
constexpr double kFarthestM = 5.5;
/// Nothing nearer to the mirror has been passed, or is anything but the robot.
constexpr double kNearestM = 0.3;
/// So near before its end a beam has passed nothing: noise, and the cell itself.
constexpr double kBeforeEndM = 0.15;
/// Beams side by side that end farther apart are on different things.
constexpr double kGapM = 0.25;
/// Beams that one edge brings into free space, where two surfaces merge, are one or two.
constexpr std::size_t kFewestBeams = 3;
constexpr double kLeastFree = 0.6;
constexpr double kWidestM = 0.9;
constexpr double kLeastRadiusM = 0.15;
constexpr double kMostRadiusM = 0.35;
/// Half a beam's distance to each side.
constexpr double kBesideM = 0.03;

}  // namespace

std::vector<Detection> MotionDetector::add_scan(const scan::Scan& scan,
                                                const geometry::SE2& T_odom_base) {
  std::vector<Detection> detections;
  if (scan.ranges_m.empty()) {
    return detections;
  }
  space_.begin_scan(T_odom_base.translation());
  collect_hits(scan, T_odom_base);
  const Eigen::Vector2d sensor_odom =
      T_odom_base * Eigen::Vector2d(scan.T_base_mount.translation().head<2>());
  std::size_t first = 0;
  for (std::size_t i = 1; i <= hits_.size(); ++i) {
    const bool goes_on = i < hits_.size() && hits_[i].beam - hits_[i - 1].beam <= 2 &&
                         (hits_[i].p_odom - hits_[i - 1].p_odom).norm() < kGapM;
    if (goes_on) {
      continue;
    }
    if (const auto detection = detect(first, i, sensor_odom)) {
      detections.push_back(*detection);
    }
    first = i;
  }
  for (const Hit& hit : hits_) {
    space_.hit(hit.p_odom, hit.height_m);
  }
  add_passes(scan, T_odom_base);
  return detections;
}

void MotionDetector::collect_hits(const scan::Scan& scan, const geometry::SE2& T_odom_base) {
  hits_.clear();
  const Eigen::Matrix2d R = T_odom_base.rotation();
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    const auto range_m = static_cast<double>(scan.ranges_m[beam]);
    if (!scan.is_hit(beam) || range_m < kNearestM || range_m > kFarthestM) {
      continue;
    }
    const Eigen::Vector3d p_base = scan::point_in_base(scan, beam, range_m);
    if (p_base.z() >= EverFree::kLowestM && p_base.z() < EverFree::kHighestM) {
      hits_.push_back({beam, R * p_base.head<2>() + T_odom_base.translation(), p_base.z()});
    }
  }
}

void MotionDetector::add_passes(const scan::Scan& scan, const geometry::SE2& T_odom_base) {
  const Eigen::Matrix2d R = T_odom_base.rotation();
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    const auto range_m = static_cast<double>(scan.ranges_m[beam]);
    if (!scan.is_hit(beam) && range_m != std::numeric_limits<double>::infinity()) {
      continue;
    }
    const double until_m = std::min(range_m - kBeforeEndM, kFarthestM);
    if (until_m <= kNearestM) {
      continue;
    }
    const Eigen::Vector3d from = scan::point_in_base(scan, beam, kNearestM);
    const Eigen::Vector3d to = scan::point_in_base(scan, beam, until_m);
    space_.pass(R * from.head<2>() + T_odom_base.translation(), from.z(),
                R * to.head<2>() + T_odom_base.translation(), to.z());
  }
}

std::optional<Detection> MotionDetector::detect(std::size_t first, std::size_t end,
                                                const Eigen::Vector2d& sensor_odom) const {
  const std::size_t num = end - first;
  const double width_m = num == 0 ? 0.0 : (hits_[end - 1].p_odom - hits_[first].p_odom).norm();
  if (num < kFewestBeams || width_m > kWidestM) {
    return std::nullopt;
  }
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  std::size_t num_free = 0;
  for (std::size_t i = first; i < end; ++i) {
    mean += hits_[i].p_odom / static_cast<double>(num);
    num_free += space_.is_free(hits_[i].p_odom, hits_[i].height_m) ? 1 : 0;
  }
  if (static_cast<double>(num_free) < kLeastFree * static_cast<double>(num)) {
    return std::nullopt;
  }
  const double radius_m = std::clamp(0.5 * width_m + kBesideM, kLeastRadiusM, kMostRadiusM);
  // Of a disc's front, seen by beams at equal distances, the mean lies pi/4 radius before the
  // centre.
  const Eigen::Vector2d away = (mean - sensor_odom).normalized();
  return Detection{mean + 0.25 * geometry::kPi * radius_m * away, radius_m, hits_[first].beam,
                   hits_[end - 1].beam};
}

}  // namespace nodmap::navigator
