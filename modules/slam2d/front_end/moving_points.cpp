// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/front_end/moving_points.hpp"

#include <algorithm>
#include <utility>

#include "common/geometry/pose_tolerance.hpp"

namespace nodmap::slam2d {
namespace {

// Keyframes within this distance and rotation by odometry are compared: they show nearly the same,
// and odometry over them is still precise.
constexpr geometry::PoseTolerance kNear{.distance_m = 1.0, .rotation_rad = 0.6};
constexpr std::size_t kMaxViews = 8;

View view_of(const LevelScan& scan) {
  std::vector<Eigen::Vector2d> points_base;
  points_base.reserve(scan.points_base.size());
  for (const OrientedPoint& point : scan.points_base) {
    points_base.push_back(point.p);
  }
  return {std::move(points_base), scan.sensor_origin_base};
}

}  // namespace

bool MovingPointFilter::contradicts(const LevelScan& scan) const {
  if (views_.empty()) {
    return false;
  }
  const KeyframeView& last = views_.back();
  return last.view.contradicts(view_of(scan), last.T_odom_base.inverse() * scan.T_odom_base);
}

void MovingPointFilter::add_keyframe(const LevelScan& scan) {
  views_.push_back({scan.T_odom_base, view_of(scan)});
  if (views_.size() > kMaxViews) {
    views_.pop_front();
  }
}

void MovingPointFilter::move_views(const geometry::SE2& T_old_new) {
  for (KeyframeView& view : views_) {
    view.T_odom_base = T_old_new.inverse() * view.T_odom_base;
  }
}

const MovingPointFilter::KeyframeView& MovingPointFilter::oldest_near(
    const geometry::SE2& T_odom_base) const {
  return *std::find_if(views_.begin(), views_.end() - 1, [&](const KeyframeView& view) {
    return geometry::is_within(view.T_odom_base, T_odom_base, kNear);
  });
}

std::span<const OrientedPoint> MovingPointFilter::stationary(const LevelScan& scan) {
  const std::span<const OrientedPoint> points = scan.points_base;
  if (views_.empty()) {
    return points;
  }
  const KeyframeView& last = views_.back();
  const KeyframeView& old = oldest_near(scan.T_odom_base);
  const geometry::SE2 T_last_base = last.T_odom_base.inverse() * scan.T_odom_base;
  const geometry::SE2 T_old_base = old.T_odom_base.inverse() * scan.T_odom_base;
  const Eigen::Matrix2d R_last_base = T_last_base.rotation();
  const Eigen::Matrix2d R_old_base = T_old_base.rotation();
  const auto has_moved_there = [&](const Eigen::Vector2d& p_base) {
    return last.view.saw_free(R_last_base * p_base + T_last_base.translation()) ||
           (&old != &last && old.view.saw_free(R_old_base * p_base + T_old_base.translation()));
  };
  stationary_.clear();
  for (std::size_t begin = 0; begin < points.size();) {
    std::size_t end = begin;
    while (end < points.size() && has_moved_there(points[end].p)) {
      ++end;
    }
    // A person at 7 m gives three points at one beam per degree.
    if (end - begin < View::kMinPoints) {
      stationary_.insert(stationary_.end(), points.begin() + static_cast<std::ptrdiff_t>(begin),
                         points.begin() + static_cast<std::ptrdiff_t>(end));
    }
    if (end < points.size()) {
      stationary_.push_back(points[end]);
    }
    begin = end + 1;
  }
  return stationary_;
}

}  // namespace nodmap::slam2d
