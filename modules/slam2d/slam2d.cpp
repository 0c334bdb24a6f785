// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/slam2d.hpp"

#include <cmath>
#include <utility>

namespace nodmap::slam2d {
namespace {

constexpr std::size_t kMinPoints = 10;

// How much better than the one from odometry another match has to be, and what it costs to be far
// from odometry.
constexpr double kSearchGain = 0.05;
constexpr double kDepartureCost = 0.1;

bool is_finite(const geometry::SE2& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.yaw);
}

double distance(const geometry::SE2& a, const geometry::SE2& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

}  // namespace

void draw(const Keyframe& keyframe, const geometry::SE2& T_map_base, OccupancyGrid& grid) {
  const Eigen::Vector2d eye = T_map_base * keyframe.eye_base;
  for (const Eigen::Vector2f& point : keyframe.points_base) {
    grid.add_ray(eye, T_map_base * Eigen::Vector2d(point.cast<double>()));
  }
}

void erase(const Keyframe& keyframe, const geometry::SE2& T_map_base, OccupancyGrid& grid) {
  const Eigen::Vector2d eye = T_map_base * keyframe.eye_base;
  for (const Eigen::Vector2f& point : keyframe.points_base) {
    grid.remove_ray(eye, T_map_base * Eigen::Vector2d(point.cast<double>()));
  }
}

Slam2d::Slam2d(const Slam2dParams& params)
    : params_(params), matcher_(params), search_(params), back_end_(params) {}

std::optional<Slam2dResult> Slam2d::add_scan(const scan::Scan& scan,
                                             const geometry::SE2& T_odom_base,
                                             const geometry::SE2& T_first_last) {
  if (!scan::is_plausible(scan) || !is_finite(T_odom_base) || !is_finite(T_first_last)) {
    return std::nullopt;
  }
  const std::span<const SurfacePoint> points = surface_.points(scan, T_first_last);
  if (back_end_.empty() && points.size() < kMinPoints) {
    return std::nullopt;
  }
  // The data set D of Eq. 3, at the pose by odometry.
  Slam2dResult result;
  result.utime_us = scan.utime_us;
  result.T_map_base = T_map_odom_ * T_odom_base;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  // The transform that minimises Eq. 3 also corrects the pose.
  if (back_end_.empty()) {
    result.quality = PoseQuality::kTracked;
  } else {
    const geometry::SE2 T_map_local = back_end_.local().T_map_submap;
    const Match match =
        match_or_search(points, T_map_local.inverse() * result.T_map_base, T_odom_base);
    result.quality = judge(match, points.size());
    result.match_share = match.share;
    result.match_agreement = match.agreement;
    result.match_rms_m = match.rms_m;
    if (result.quality <= PoseQuality::kPartly) {
      result.T_map_base = T_map_local * match.T_map_base;
      information = match.information;
    }
  }
  // The scan goes into the map when the robot has moved on.
  if (is_due_for_map(T_odom_base, result.quality)) {
    add_keyframe(points, result, T_odom_base, scan::point_in_base(scan, 0, 0.0).head<2>(),
                 information);
    result.T_map_base = keyframes().back().T_map_base;
    result.map_changed = true;
  }
  T_map_odom_ = result.T_map_base * T_odom_base.inverse();
  result.T_map_odom = T_map_odom_;
  record(result);
  return result;
}

void Slam2d::change_odometry_frame(const geometry::SE2& T_old_odom_base,
                                   const geometry::SE2& T_new_odom_base) {
  const geometry::SE2 T_old_new = T_old_odom_base * T_new_odom_base.inverse();
  T_map_odom_ = T_map_odom_ * T_old_new;
  T_odom_keyframe_ = T_old_new.inverse() * T_odom_keyframe_;
  T_odom_failed_search_.reset();  // the robot may have been moved: it is worth a search
}

Match Slam2d::match_or_search(std::span<const SurfacePoint> points,
                              const geometry::SE2& T_local_base_guess,
                              const geometry::SE2& T_odom_base) {
  Match best = matcher_.match(back_end_.local().points, points, T_local_base_guess);
  if (best.agreement >= params_.search_below_agreement || points.size() < kMinPoints) {
    T_odom_failed_search_.reset();
    return best;
  }
  // A search that found nothing finds nothing again before the robot has moved on.
  if (T_odom_failed_search_ &&
      distance(*T_odom_failed_search_, T_odom_base) < params_.keyframe_distance_m &&
      std::abs(geometry::angle_difference(T_odom_failed_search_->yaw, T_odom_base.yaw)) <
          params_.keyframe_rotation_rad) {
    return best;
  }
  ++figures_.searches;
  double to_beat = best.agreement + kSearchGain;
  T_odom_failed_search_ = T_odom_base;
  for (const geometry::SE2& start :
       search_.candidates(back_end_.local().points, points, T_local_base_guess)) {
    const Match match = matcher_.match(back_end_.local().points, points, start);
    const double value =
        match.agreement - kDepartureCost * search_.departure(match.T_map_base, T_local_base_guess);
    if (match.found() && value > to_beat) {
      to_beat = value;
      best = match;
      T_odom_failed_search_.reset();
    }
  }
  figures_.searches_helped += T_odom_failed_search_ ? 0 : 1;
  return best;
}

PoseQuality Slam2d::judge(const Match& match, std::size_t num_points) const {
  if (num_points < kMinPoints) {
    return PoseQuality::kOdometry;
  }
  if (!match.found() || match.agreement < params_.lost_below_agreement) {
    return PoseQuality::kLost;
  }
  return match.weak_directions > 0 ? PoseQuality::kPartly : PoseQuality::kTracked;
}

bool Slam2d::is_due_for_map(const geometry::SE2& T_odom_base, PoseQuality quality) const {
  if (quality == PoseQuality::kOdometry) {
    return false;
  }
  if (back_end_.empty()) {
    return true;
  }
  const double way = distance(T_odom_keyframe_, T_odom_base);
  if (quality == PoseQuality::kLost) {
    // Nothing here is on the map: the map goes on from odometry, once that has led far enough away.
    return way > params_.lost_distance_m;
  }
  return way > params_.keyframe_distance_m ||
         std::abs(geometry::angle_difference(T_odom_keyframe_.yaw, T_odom_base.yaw)) >
             params_.keyframe_rotation_rad;
}

void Slam2d::add_keyframe(std::span<const SurfacePoint> points, const Slam2dResult& result,
                          const geometry::SE2& T_odom_base, const Eigen::Vector2d& eye_base,
                          const Eigen::Matrix3d& information) {
  Keyframe keyframe;
  keyframe.utime_us = result.utime_us;
  keyframe.T_odom_base = T_odom_base;
  keyframe.T_map_base = result.T_map_base;
  keyframe.eye_base = eye_base;
  keyframe.points_base.reserve(points.size());
  keyframe.normals_base.reserve(points.size());
  for (const SurfacePoint& point : points) {
    keyframe.points_base.emplace_back(point.p.cast<float>());
    keyframe.normals_base.emplace_back(point.normal.cast<float>());
  }
  const geometry::SE2 T_local_keyframe =
      back_end_.empty() ? geometry::SE2{}
                        : back_end_.local().T_map_submap.inverse() * result.T_map_base;
  back_end_.add_keyframe(std::move(keyframe), T_local_keyframe, information);
  T_odom_keyframe_ = T_odom_base;
}

void Slam2d::record(const Slam2dResult& result) {
  const geometry::SE2 T_keyframe_base = keyframes().back().T_map_base.inverse() * result.T_map_base;
  tracked_scans_.push_back(
      {result.utime_us, keyframes().size() - 1, T_keyframe_base, result.T_map_base});
  ++figures_.scans;
  figures_.tracked += result.quality == PoseQuality::kTracked ? 1 : 0;
  figures_.partly += result.quality == PoseQuality::kPartly ? 1 : 0;
  figures_.odometry_only += result.quality == PoseQuality::kOdometry ? 1 : 0;
  figures_.lost += result.quality == PoseQuality::kLost ? 1 : 0;
  figures_.share_sum += result.match_share;
  figures_.agreement_sum += result.match_agreement;
}

geometry::SE2 Slam2d::corrected_pose(const TrackedScan& scan) const {
  return keyframes()[scan.keyframe].T_map_base * scan.T_keyframe_base;
}

}  // namespace nodmap::slam2d
