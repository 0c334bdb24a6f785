// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/motion_detector.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace nodmap::navigator {
namespace {

// Width of a person. Detection reaches as far as five beams fall on this width.
constexpr double kPersonM = 0.48;
constexpr double kBeamsOnPerson = 5.0;
constexpr double kFarthestPersonM = 10.0;
// Anything nearer to the mirror is the robot itself.
constexpr double kNearestM = 0.1;
// Free space is counted from this distance from the mirror on.
constexpr double kPassedFromM = 0.3;
// Free space ends this far before the end of a beam, because of noise and the size of a cell.
constexpr double kFreeBeforeEndM = 0.15;
// Hits below this are on the floor.
constexpr double kFloorHitM = 0.05;
// Neighbouring beams that end farther apart than this have hit different things.
constexpr double kGapM = 0.25;
// A detection needs this many beams: mixed pixels at an edge are one or two.
constexpr std::size_t kFewestBeams = 3;
// A group that ends within this many beams of the edge of the view may be cut off, and its centre
// would be wrong.
constexpr std::size_t kEdgeBeams = 2;
constexpr double kLeastFree = 0.6;
constexpr double kWidestM = 1.4;
constexpr double kLeastRadiusM = 0.15;
constexpr double kMostRadiusM = 0.7;
// Half the distance between neighbouring beams.
constexpr double kHalfBeamM = 0.03;

// Whether two successive hits are on the same thing.
const auto is_beside = [](const auto& a, const auto& b) {
  const std::size_t beams = std::max(a.beam, b.beam) - std::min(a.beam, b.beam);
  return beams <= 2 && (a.p_odom - b.p_odom).norm() < kGapM;
};

// Whether a beam has hit something nearer than the neighbouring beam has, so that the neighbour
// does not hide a part of it.
bool is_before(const scan::Scan& scan, std::size_t beam, std::size_t beside) {
  const auto range_m = static_cast<double>(scan.ranges_m[beside]);
  return (scan.is_hit(beside) || range_m == std::numeric_limits<double>::infinity()) &&
         range_m > static_cast<double>(scan.ranges_m[beam]);
}

double farthest_of(const scan::Scan& scan) {
  return std::min(kFarthestPersonM, kPersonM / (kBeamsOnPerson * std::abs(scan.angle_step_rad)));
}

}  // namespace

std::vector<Detection> MotionDetector::add_scan(const scan::Scan& scan,
                                                const geometry::SE2& T_odom_base,
                                                bool laser_is_held) {
  std::vector<Detection> detections;
  if (scan.ranges_m.empty()) {
    return detections;
  }
  if (farthest_of(scan) != farthest_m_) {
    farthest_m_ = farthest_of(scan);
    space_ = EverFree(farthest_m_);
  }
  space_.begin_scan(T_odom_base.translation());
  collect_hits(scan, T_odom_base);
  const Eigen::Vector2d sensor_odom =
      T_odom_base * Eigen::Vector2d(scan.T_base_mount.translation().head<2>());
  for (auto first = leg_hits_.cbegin(); first != leg_hits_.cend();) {
    const auto last = std::adjacent_find(first, leg_hits_.cend(), std::not_fn(is_beside));
    const auto end = last == leg_hits_.cend() ? last : last + 1;
    if (const auto detection = detect(first, end, sensor_odom, scan, laser_is_held)) {
      detections.push_back(*detection);
    }
    first = end;
  }
  for (const Hit& hit : leg_hits_) {
    space_.hit(hit.p_odom, hit.height_m);
  }
  add_passes(scan, T_odom_base);
  return detections;
}

void MotionDetector::collect_hits(const scan::Scan& scan, const geometry::SE2& T_odom_base) {
  num_beams_ = scan.ranges_m.size();
  hits_.clear();
  leg_hits_.clear();
  const Eigen::Matrix2d R = T_odom_base.rotation();
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    const auto range_m = static_cast<double>(scan.ranges_m[beam]);
    if (!scan.is_hit(beam) || range_m < kNearestM || range_m > farthest_m_) {
      continue;
    }
    const Eigen::Vector3d p_base = scan::point_in_base(scan, beam, range_m);
    if (p_base.z() < kFloorHitM) {
      continue;
    }
    hits_.push_back({beam, R * p_base.head<2>() + T_odom_base.translation(), p_base.z()});
    if (p_base.z() >= EverFree::kLowestM && p_base.z() < EverFree::kHighestM) {
      leg_hits_.push_back(hits_.back());
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
    // Without an echo space is free up to range_max_m.
    const double until_m = std::min({range_m - kFreeBeforeEndM, farthest_m_, scan.range_max_m});
    if (until_m <= kPassedFromM) {
      continue;
    }
    const Eigen::Vector3d from = scan::point_in_base(scan, beam, kPassedFromM);
    const Eigen::Vector3d to = scan::point_in_base(scan, beam, until_m);
    space_.pass(R * from.head<2>() + T_odom_base.translation(), from.z(),
                R * to.head<2>() + T_odom_base.translation(), to.z());
  }
}

std::span<const MotionDetector::Hit> MotionDetector::whole_group(const Hit& first,
                                                                 const Hit& last) const {
  auto begin = std::ranges::lower_bound(hits_, first.beam, {}, &Hit::beam);
  auto end = std::ranges::upper_bound(hits_, last.beam, {}, &Hit::beam);
  const auto fits = [&](const Hit& hit, const Hit& beside, const Hit& farthest) {
    return is_beside(hit, beside) && (hit.p_odom - farthest.p_odom).norm() < kWidestM;
  };
  while (begin != hits_.begin() && fits(*(begin - 1), *begin, *(end - 1))) {
    --begin;
  }
  while (end != hits_.end() && fits(*end, *(end - 1), *begin)) {
    ++end;
  }
  return {begin, end};
}

std::optional<Detection> MotionDetector::detect(Hits::const_iterator first,
                                                Hits::const_iterator end,
                                                const Eigen::Vector2d& sensor_odom,
                                                const scan::Scan& scan, bool laser_is_held) const {
  const auto num = static_cast<std::size_t>(end - first);
  if (num < kFewestBeams || ((end - 1)->p_odom - first->p_odom).norm() > kWidestM) {
    return std::nullopt;
  }
  const auto num_free = std::count_if(first, end, [&](const Hit& hit) {
    return space_.is_free(hit.p_odom, hit.height_m, laser_is_held);
  });
  const double free_ratio = static_cast<double>(num_free) / static_cast<double>(num);
  if (free_ratio < kLeastFree && !laser_is_held) {
    return std::nullopt;
  }
  const std::span<const Hit> group = whole_group(*first, *(end - 1));
  if (group.front().beam < kEdgeBeams || group.back().beam + kEdgeBeams >= num_beams_) {
    return std::nullopt;
  }
  if (free_ratio < kLeastFree && (!is_before(scan, group.front().beam, group.front().beam - 1) ||
                                  !is_before(scan, group.back().beam, group.back().beam + 1))) {
    return std::nullopt;
  }
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Hit& hit : group) {
    mean += hit.p_odom / static_cast<double>(group.size());
  }
  const double width_m = (group.back().p_odom - group.front().p_odom).norm();
  const double radius_m = std::clamp(0.5 * width_m + kHalfBeamM, kLeastRadiusM, kMostRadiusM);
  // Equally spaced beams on the front of a disc have their mean pi/4 of the radius before its
  // centre.
  const Eigen::Vector2d away = (mean - sensor_odom).normalized();
  const auto [lowest, highest] = std::ranges::minmax(group, {}, &Hit::height_m);
  return Detection{mean + 0.25 * geometry::kPi * radius_m * away, radius_m, lowest.height_m,
                   highest.height_m, free_ratio};
}

}  // namespace nodmap::navigator
