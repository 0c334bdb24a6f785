// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/moving_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nodmap::slam2d {
namespace {

// Nearer to the point measured before, it may be the same thing: noise, an edge seen from the side,
// an error of odometry.
constexpr double kMarginM = 0.3;
constexpr double kMaxMovingRatio = 0.5;
// People who come nearer, and edges, are as much of a scan at a place that is right.
constexpr double kMaxDeniedRatio = 0.25;
// From how far away an older keyframe still shows the same, and odometry still tells from where.
constexpr double kNearM = 1.0;
constexpr double kNearRad = 0.6;
constexpr std::size_t kMaxViews = 8;
// Of somebody at 7 m there are three at every degree. Fewer may be a thin thing, or an edge, that
// the beams of the reference have missed.
constexpr std::size_t kMinPoints = 3;

std::size_t bin_of(const Eigen::Vector2d& direction, std::size_t num_bins) {
  const double turns = std::atan2(direction.y(), direction.x()) / (2.0 * geometry::kPi) + 0.5;
  return static_cast<std::size_t>(turns * static_cast<double>(num_bins)) % num_bins;
}

}  // namespace

// As far as the nearest point within a degree or two is, so that a thin thing between two beams is
// not taken for free space.
MovingPointFilter::View::View(const LevelScan& scan)
    : T_odom_base(scan.T_odom_base), sensor_origin_base(scan.sensor_origin_base) {
  constexpr double kNothing = std::numeric_limits<double>::infinity();
  std::array<double, kNumBins> nearest_m;
  nearest_m.fill(kNothing);
  for (const OrientedPoint& point : scan.points_base) {
    points_base.push_back(point.p);
    const Eigen::Vector2d ray = point.p - sensor_origin_base;
    double& nearest = nearest_m[bin_of(ray, kNumBins)];
    nearest = std::min(nearest, ray.norm());
  }
  for (std::size_t i = 0; i < kNumBins; ++i) {
    const double nearest = std::min(
        {nearest_m[(i + kNumBins - 1) % kNumBins], nearest_m[i], nearest_m[(i + 1) % kNumBins]});
    free_m[i] = nearest == kNothing ? 0.0 : nearest;
    farthest_free_m = std::max(farthest_free_m, free_m[i]);
  }
}

bool MovingPointFilter::View::saw_free(const Eigen::Vector2d& p_base) const {
  const Eigen::Vector2d ray = p_base - sensor_origin_base;
  const double needed_m = ray.norm() + kMarginM;
  return needed_m < farthest_free_m && needed_m < free_m[bin_of(ray, kNumBins)];
}

// Of the points in directions in which this view knows how far it saw.
bool MovingPointFilter::View::denies(const View& other) const {
  const geometry::SE2 T_this_other = T_odom_base.inverse() * other.T_odom_base;
  std::size_t compared = 0;
  std::size_t denied = 0;
  for (const Eigen::Vector2d& p_other : other.points_base) {
    const Eigen::Vector2d p = T_this_other * p_other;
    compared += free_m[bin_of(p - sensor_origin_base, kNumBins)] > 0.0 ? 1 : 0;
    denied += saw_free(p) ? 1 : 0;
  }
  return denied >= kMinPoints &&
         static_cast<double>(denied) > kMaxDeniedRatio * static_cast<double>(compared);
}

bool MovingPointFilter::contradicts(const LevelScan& scan) const {
  if (views_.empty()) {
    return false;
  }
  const View now(scan);
  return now.denies(views_.back()) || views_.back().denies(now);
}

void MovingPointFilter::add_keyframe(const LevelScan& scan) {
  views_.emplace_back(scan);
  if (views_.size() > kMaxViews) {
    views_.pop_front();
  }
}

void MovingPointFilter::change_odometry_frame(const geometry::SE2& T_old_new) {
  for (View& view : views_) {
    view.T_odom_base = T_old_new.inverse() * view.T_odom_base;
  }
}

const MovingPointFilter::View& MovingPointFilter::oldest_near(
    const geometry::SE2& T_odom_base) const {
  return *std::find_if(views_.begin(), views_.end() - 1, [&](const View& view) {
    return (view.T_odom_base.translation() - T_odom_base.translation()).norm() < kNearM &&
           std::abs(geometry::angle_difference(view.T_odom_base.yaw, T_odom_base.yaw)) < kNearRad;
  });
}

std::span<const OrientedPoint> MovingPointFilter::stationary(const LevelScan& scan) {
  const std::span<const OrientedPoint> points = scan.points_base;
  if (views_.empty()) {
    return points;
  }
  const View& last = views_.back();
  const View& old = oldest_near(scan.T_odom_base);
  const geometry::SE2 T_last_base = last.T_odom_base.inverse() * scan.T_odom_base;
  const geometry::SE2 T_old_base = old.T_odom_base.inverse() * scan.T_odom_base;
  const Eigen::Matrix2d R_last_base = T_last_base.rotation();
  const Eigen::Matrix2d R_old_base = T_old_base.rotation();
  const auto has_moved_there = [&](const Eigen::Vector2d& p_base) {
    return last.saw_free(R_last_base * p_base + T_last_base.translation()) ||
           (&old != &last && old.saw_free(R_old_base * p_base + T_old_base.translation()));
  };
  stationary_.clear();
  std::size_t moving = 0;
  for (std::size_t begin = 0; begin < points.size();) {
    std::size_t end = begin;
    while (end < points.size() && has_moved_there(points[end].p)) {
      ++end;
    }
    if (end - begin >= kMinPoints) {
      moving += end - begin;
    } else {
      stationary_.insert(stationary_.end(), points.begin() + static_cast<std::ptrdiff_t>(begin),
                         points.begin() + static_cast<std::ptrdiff_t>(end));
    }
    if (end < points.size()) {
      stationary_.push_back(points[end]);
    }
    begin = end + 1;
  }
  const bool is_elsewhere =
      static_cast<double>(moving) > kMaxMovingRatio * static_cast<double>(points.size());
  return is_elsewhere ? points : stationary_;
}

}  // namespace nodmap::slam2d
