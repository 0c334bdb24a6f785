// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/front_end/slip_detector.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "modules/slam2d/matching/best_place.hpp"
#include "modules/slam2d/scan/view.hpp"

namespace nodmap::slam2d {
namespace {

// Less slip than this a match undoes by itself.
constexpr double kMinSlipM = 0.12;
constexpr double kMinSlipRad = 0.12;
// From start poses at most this far apart a match finds every pose between them.
constexpr double kStepM = 0.3;
constexpr double kMaxSteps = 6.0;
// A point is on a line of the map, or not.
constexpr double kOnLineM = 0.08;
constexpr double kReachM = 0.25;
// Longer than people who walk abreast, between whom there are gaps.
constexpr double kMinWallM = 2.0;
constexpr double kMaxGapM = 0.5;
// Keyframes this far back show somebody who walks ahead elsewhere.
constexpr double kElsewhereM = 0.5;
constexpr std::size_t kMaxKeyframes = 20;
constexpr double kSamePointM = 0.15;

bool is_on_map(const PointMap& map, const OrientedPoint& point) {
  const MapPoint* const nearest = map.nearest(point, kReachM);
  if (nearest == nullptr) {
    return false;
  }
  return nearest->has_line()
             ? std::abs(nearest->line_normal.dot(point.p - nearest->line_point)) < kOnLineM
             : (point.p - nearest->point.p).norm() < kOnLineM;
}

// Whether each point of a scan is on the map if the scan was taken at one pose, and not if it was
// taken at another. Points on walls along which the two differ do not count: farther on such a wall
// is not in the map yet.
std::vector<bool> only_at(const PointMap& map, const LevelScan& scan, const geometry::SE2& here,
                          const geometry::SE2& other) {
  const std::vector<OrientedPoint> points = transformed(here, scan.points_base);
  const std::vector<OrientedPoint> elsewhere = transformed(other, scan.points_base);
  std::vector<bool> are_only_here(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    are_only_here[i] = std::abs(points[i].normal.dot(elsewhere[i].p - points[i].p)) > kOnLineM &&
                       is_on_map(map, points[i]) && !is_on_map(map, elsewhere[i]);
  }
  return are_only_here;
}

// The length of the longest wall of these points.
double longest_wall_m(const LevelScan& scan, const std::vector<bool>& are_chosen) {
  double longest_m = 0.0;
  std::optional<Eigen::Vector2d> first;
  Eigen::Vector2d last = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < are_chosen.size(); ++i) {
    if (!are_chosen[i]) {
      continue;
    }
    const Eigen::Vector2d& p = scan.points_base[i].p;
    if (!first || (p - last).norm() > kMaxGapM) {
      first = p;
    }
    last = p;
    longest_m = std::max(longest_m, (p - *first).norm());
  }
  return longest_m;
}

std::vector<OrientedPoint> chosen_points(const LevelScan& scan, const std::vector<bool>& are_chosen,
                                         bool value) {
  std::vector<OrientedPoint> points;
  for (std::size_t i = 0; i < are_chosen.size(); ++i) {
    if (are_chosen[i] == value) {
      points.push_back(scan.points_base[i]);
    }
  }
  return points;
}

// Poses from that of the last scan to shortly before that by odometry, in base at the last scan;
// also one without a rotation.
std::vector<geometry::SE2> poses_short_of(const geometry::SE2& T_last_odometry) {
  const double counted_m = T_last_odometry.translation().norm();
  const double steps = std::min(std::ceil(counted_m / kStepM), kMaxSteps);
  std::vector<geometry::SE2> poses;
  for (double i = 0.0; i < steps; ++i) {
    const double ratio = i / steps;
    poses.push_back({ratio * T_last_odometry.x, ratio * T_last_odometry.y, T_last_odometry.yaw});
  }
  if (std::abs(T_last_odometry.yaw) > kMinSlipRad) {
    poses.emplace_back();
  }
  return poses;
}

// Whether a motion is a part of the one that was counted: wheels that slip count too much, and the
// rotation has the sign and at most the size of theirs.
bool is_part_of(const geometry::SE2& moved, const geometry::SE2& counted) {
  return moved.translation().norm() <= counted.translation().norm() - kMinSlipM &&
         moved.yaw >= std::min(0.0, counted.yaw) - kMinSlipRad &&
         moved.yaw <= std::max(0.0, counted.yaw) + kMinSlipRad;
}

}  // namespace

SlipFinding SlipDetector::check(const LevelScan& scan, const geometry::SE2& T_map_last,
                                const geometry::SE2& T_map_odometry) const {
  const double counted_m = distance_m(T_map_last, T_map_odometry);
  if (!scan.has_enough_to_search() || counted_m < kMinSlipM) {
    return {};
  }
  const PointMap& map = back_end_.local().points;
  const geometry::SE2& T_map_submap = back_end_.local().T_map_submap;
  const geometry::SE2 T_submap_last = T_map_submap.inverse() * T_map_last;
  const geometry::SE2 T_submap_odometry = T_map_submap.inverse() * T_map_odometry;
  const Match by_odometry = matcher_.match(map, scan.points_base, T_submap_odometry);
  const std::optional<Match> better =
      find_better(scan, T_submap_last, T_submap_odometry, by_odometry.score + min_gain_);
  const Match& best = better ? *better : by_odometry;
  const geometry::SE2& T_submap_base = best.T_target_base;
  if (best.score < min_score_ || !is_part_of(T_submap_last.inverse() * T_submap_base,
                                             T_submap_last.inverse() * T_submap_odometry)) {
    return {.match = by_odometry};
  }
  const std::vector<bool> are_only_here = only_at(map, scan, T_submap_base, T_submap_odometry);
  const std::vector<OrientedPoint> only_here = chosen_points(scan, are_only_here, true);
  const std::vector<bool> are_only_there = only_at(map, scan, T_submap_odometry, T_submap_base);
  const auto num_only_there = static_cast<std::size_t>(std::ranges::count(are_only_there, true));
  if (only_here.size() < View::kMinPoints || only_here.size() < 2 * num_only_there) {
    return {.match = by_odometry};
  }
  const geometry::SE2 T_map_base = T_map_submap * T_submap_base;
  const bool has_slipped = longest_wall_m(scan, are_only_here) > kMinWallM ||
                           was_seen_from_elsewhere(transformed(T_map_base, only_here), T_map_last);
  if (has_slipped && (better || !is_same_place(T_submap_base, T_submap_odometry))) {
    return {.T_map_base = T_map_base};
  }
  // Half of the scan or more is not somebody.
  if (!has_slipped && 2 * only_here.size() < scan.points_base.size()) {
    return {.points_without_people = chosen_points(scan, are_only_here, false)};
  }
  return {.match = by_odometry};
}

// The best match from a pose short of odometry that scores more than `min_score`, if any does.
std::optional<Match> SlipDetector::find_better(const LevelScan& scan,
                                               const geometry::SE2& T_submap_last,
                                               const geometry::SE2& T_submap_odometry,
                                               double min_score) const {
  if (min_score >= 1.0) {
    return std::nullopt;
  }
  std::optional<Match> best;
  for (const geometry::SE2& T_last_guess :
       poses_short_of(T_submap_last.inverse() * T_submap_odometry)) {
    const Match match =
        matcher_.match(back_end_.local().points, scan.points_base, T_submap_last * T_last_guess);
    if (match.score > (best ? best->score : min_score)) {
      best = match;
    }
  }
  return best;
}

// Whether earlier keyframes, from farther back, show most of these points.
bool SlipDetector::was_seen_from_elsewhere(const std::vector<OrientedPoint>& points_map,
                                           const geometry::SE2& T_map_last) const {
  const std::span<const Keyframe> all = back_end_.keyframes();
  const std::span<const Keyframe> recent = all.last(std::min(all.size(), kMaxKeyframes));
  const auto is_seen_in = [](const Keyframe& keyframe, const Eigen::Vector2d& p_base) {
    return std::any_of(
        keyframe.points_base.begin(), keyframe.points_base.end(),
        [&](const Eigen::Vector2f& p) { return (p.cast<double>() - p_base).norm() < kSamePointM; });
  };
  const auto is_seen = [&](const OrientedPoint& point) {
    return std::any_of(recent.begin(), recent.end(), [&](const Keyframe& keyframe) {
      return distance_m(keyframe.T_map_base, T_map_last) > kElsewhereM &&
             is_seen_in(keyframe, keyframe.T_map_base.inverse() * point.p);
    });
  };
  const auto seen = std::count_if(points_map.begin(), points_map.end(), is_seen);
  return 2 * static_cast<std::size_t>(seen) > points_map.size();
}

}  // namespace nodmap::slam2d
