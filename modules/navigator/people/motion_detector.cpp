// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/motion_detector.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "modules/navigator/local_map/mixed_pixel.hpp"
#include "modules/navigator/people/legs.hpp"

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
constexpr std::size_t kMinBeams = 3;
// A group that ends within this many beams of the edge of the view may be cut off, and its centre
// would be wrong.
constexpr std::size_t kEdgeBeams = 2;
constexpr double kMinFree = 0.6;
constexpr double kWidestM = 1.4;
constexpr double kMinRadiusM = 0.15;
constexpr double kMaxRadiusM = 0.7;
// A leg is no wider than this; the legs of a person have a gap between them, in direction or in
// range.
constexpr double kLegM = 0.2;
constexpr double kLegRadiusM = 0.07;
constexpr double kBetweenLegsM = 0.12;
constexpr std::size_t kBeamsOnLeg = 2;
// Half the distance between neighbouring beams.
constexpr double kHalfBeamM = 0.03;

// Whether two successive hits are on the same thing.
const auto is_beside = [](const auto& a, const auto& b) {
  const std::size_t beams = std::max(a.beam, b.beam) - std::min(a.beam, b.beam);
  return beams <= 2 && (a.p_odom - b.p_odom).norm() < kGapM;
};

// Whether there may be a gap between two successive hits.
const auto has_gap = [](const auto& a, const auto& b) {
  return b.beam - a.beam > 1 || (a.p_odom - b.p_odom).norm() > kBetweenLegsM;
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
  space_.begin_scan(scan.mid_stamp(), T_odom_base);
  collect_hits(scan, T_odom_base, laser_is_held);
  const Eigen::Vector2d sensor_odom =
      T_odom_base * Eigen::Vector2d(scan.T_base_mount.translation().head<2>());
  for (auto first = leg_hits_.cbegin(); first != leg_hits_.cend();) {
    const auto last = std::adjacent_find(first, leg_hits_.cend(), std::not_fn(is_beside));
    const auto end = last == leg_hits_.cend() ? last : last + 1;
    detect(first, end, sensor_odom, scan, laser_is_held, detections);
    first = end;
  }
  for (const Hit& hit : leg_hits_) {
    space_.hit(hit.p_odom, hit.height_m);
  }
  add_passes(scan, T_odom_base);
  return laser_is_held ? detections : join_legs(detections);
}

// Mixed pixels are in free space, where nothing is. To a laser that is held, one of them beside
// three other beams on a post would be a fourth of something that has come. To one that nods, a leg
// is two or three beams wide, and what is measured at one height is nobody.
void MotionDetector::collect_hits(const scan::Scan& scan, const geometry::SE2& T_odom_base,
                                  bool laser_is_held) {
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
    if (p_base.z() < kFloorHitM || (laser_is_held && is_mixed_pixel(scan, beam))) {
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

void MotionDetector::detect(Hits::const_iterator first, Hits::const_iterator end,
                            const Eigen::Vector2d& sensor_odom, const scan::Scan& scan,
                            bool laser_is_held, std::vector<Detection>& detections) const {
  const auto num = static_cast<std::size_t>(end - first);
  const double apart_m = ((end - 1)->p_odom - first->p_odom).norm();
  if (num < (laser_is_held ? kMinBeams : kBeamsOnLeg) || apart_m > kWidestM) {
    return;
  }
  const auto num_free = std::count_if(first, end, [&](const Hit& hit) {
    return space_.is_free(hit.p_odom, hit.height_m, laser_is_held);
  });
  const double free_ratio = static_cast<double>(num_free) / static_cast<double>(num);
  if (free_ratio < kMinFree && !laser_is_held) {
    return;
  }
  const std::span<const Hit> group = whole_group(*first, *(end - 1));
  if (group.front().beam < kEdgeBeams || group.back().beam + kEdgeBeams >= num_beams_) {
    return;
  }
  if (free_ratio < kMinFree && (!is_before(scan, group.front().beam, group.front().beam - 1) ||
                                !is_before(scan, group.back().beam, group.back().beam + 1))) {
    return;
  }
  const auto add = [&](std::span<const Hit> part, bool is_leg) {
    detections.push_back(detection_of(part, is_leg, sensor_odom));
    detections.back().free_ratio = free_ratio;
  };
  const auto gap = std::ranges::adjacent_find(group, has_gap);
  const auto num_before = static_cast<std::size_t>(gap - group.begin()) + 1;
  if (!laser_is_held && gap != group.end() && is_leg(group.first(num_before)) &&
      is_leg(group.subspan(num_before))) {
    add(group.first(num_before), true);
    add(group.subspan(num_before), true);
  } else {
    add(group, !laser_is_held && is_leg(group));
  }
}

bool MotionDetector::is_leg(std::span<const Hit> group) {
  return group.size() >= kBeamsOnLeg &&
         (group.back().p_odom - group.front().p_odom).norm() <= kLegM;
}

Detection MotionDetector::detection_of(std::span<const Hit> group, bool is_leg,
                                       const Eigen::Vector2d& sensor_odom) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Hit& hit : group) {
    mean += hit.p_odom / static_cast<double>(group.size());
  }
  const double width_m = (group.back().p_odom - group.front().p_odom).norm();
  const auto [lowest, highest] = std::ranges::minmax(group, {}, &Hit::height_m);
  Detection detection;
  detection.radius_m = std::clamp(0.5 * width_m + kHalfBeamM, kMinRadiusM, kMaxRadiusM);
  // Equally spaced beams on the front of a disc have their mean pi/4 of the radius before its
  // centre.
  const Eigen::Vector2d away = (mean - sensor_odom).normalized();
  detection.p_odom =
      mean + 0.25 * geometry::kPi * (is_leg ? kLegRadiusM : detection.radius_m) * away;
  detection.lowest_m = lowest.height_m;
  detection.highest_m = highest.height_m;
  detection.num_legs = is_leg ? 1 : 0;
  detection.num_beams = group.size();
  return detection;
}

}  // namespace nodmap::navigator
