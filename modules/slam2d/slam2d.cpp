// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/slam2d.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nodmap::slam2d {
namespace {

double distance_m(const geometry::SE2& a, const geometry::SE2& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

}  // namespace

Slam2d::Slam2d(const Slam2dParams& params)
    : params_(params),
      input_(params.level_scans),
      matcher_(params.matcher),
      search_(params.search),
      back_end_(params.back_end, params.map, params.matcher) {}

void Slam2d::change_odometry_frame(const geometry::SE3& T_new_odom_base) {
  const geometry::SE2 T_old_new = input_.change_odometry_frame(T_new_odom_base);
  T_map_odom_ = T_map_odom_ * T_old_new;
  T_odom_keyframe_ = T_old_new.inverse() * T_odom_keyframe_;
  T_odom_last_ = T_old_new.inverse() * T_odom_last_;
  moving_points_.change_odometry_frame(T_old_new);
  pose_guesses_.change_odometry_frame(T_old_new);
  T_odom_failed_search_.reset();  // the robot may have been carried: another search is worth it
}

std::optional<PoseUpdate> Slam2d::add_scan(const scan::Scan& scan) {
  // "... extracting exactly those 2D scans that have been taken in the horizontal position."
  const std::optional<LevelScan> all_points = input_.add_scan(scan);
  if (!all_points) {
    return std::nullopt;
  }
  if (!back_end_.has_local()) {
    moving_points_.add_keyframe(*all_points);
    return begin_map(*all_points);
  }
  pose_covariance_.move(T_map_odom_.yaw + T_odom_last_.yaw,
                        T_odom_last_.inverse() * all_points->T_odom_base);
  if (all_points->has_odometry_gap()) {
    odometry_is_in_doubt_ = true;
    pose_covariance_.lose_track(all_points->odometry_gap_s);
  }
  const Start start = choose_start(*all_points);
  LevelScan level_scan = *all_points;
  if (start.is_by_odometry && !odometry_is_in_doubt_) {
    level_scan.points_base = moving_points_.stationary(*all_points);
  }
  // "These can directly be used as data set D and matched against an incrementally built 2D map" M:
  // the transform that minimises Eq. 3, from the pose by odometry.
  const Match match = match_or_search(level_scan, start.guesses);
  // The same transform corrects the pose.
  PoseUpdate update = correct_pose(*all_points, match);
  update.covariance = estimate_covariance(match, update);
  odometry_is_in_doubt_ = update.quality == PoseQuality::kLost ||
                          (odometry_is_in_doubt_ && update.quality == PoseQuality::kOdometry);
  lost_since_ = update.quality == PoseQuality::kLost
                    ? std::optional(lost_since_.value_or(update.stamp))
                    : std::nullopt;
  pose_guesses_.add_scan(update.stamp, (T_map_odom_ * T_odom_last_).inverse() * update.T_map_base);
  if (update.quality == PoseQuality::kLost) {
    pose_guesses_.forget_motion();
  }
  // "New scan points that do not show a correspondence to already existing points in M are added."
  // That may close a loop, which corrects the pose once more.
  if (is_keyframe(update, *all_points)) {
    add_keyframe(level_scan, match, update);
    moving_points_.add_keyframe(*all_points);
  }
  correct_odometry(level_scan, update);
  record(update);
  return update;
}

std::vector<geometry::SE2> Slam2d::trajectory() const {
  std::vector<geometry::SE2> poses;
  poses.reserve(tracked_scans_.size());
  for (const TrackedScan& scan : tracked_scans_) {
    poses.push_back(keyframes()[scan.keyframe].T_map_base * scan.T_keyframe_base);
  }
  return poses;
}

std::optional<PoseUpdate> Slam2d::begin_map(const LevelScan& scan) {
  if (!scan.has_enough_points()) {
    ++metrics_.scans_without_points;
    return std::nullopt;
  }
  PoseUpdate update{.stamp = scan.stamp,
                    .T_map_base = T_map_odom_ * scan.T_odom_base,
                    .quality = PoseQuality::kTracked};
  add_keyframe(scan, {}, update);
  correct_odometry(scan, update);
  record(update);
  return update;
}

// Where odometry contradicts the motion of the robot, the guess from which the scan fits clearly
// better. All of its points count: what has moved is told by odometry, which is in doubt.
Slam2d::Start Slam2d::choose_start(const LevelScan& scan) const {
  const Submap& submap = back_end_.local();
  Start start{pose_guesses_.guesses(scan, T_map_odom_, T_odom_last_)};
  for (geometry::SE2& guess : start.guesses) {
    guess = submap.T_map_submap.inverse() * guess;
  }
  if (start.guesses.size() == 1) {
    return start;
  }
  const double min_gain = params_.search.min_gain;
  std::size_t best = 0;
  double best_score = -min_gain;
  for (std::size_t i = 0; i < start.guesses.size(); ++i) {
    const Match match = matcher_.match(submap.points, scan.points_base, start.guesses[i]);
    if (match.score > best_score + min_gain) {
      best = i;
      best_score = match.score;
    }
  }
  std::swap(start.guesses[0], start.guesses[best]);
  start.is_by_odometry = best == 0;
  return start;
}

Match Slam2d::match_or_search(const LevelScan& scan, std::span<const geometry::SE2> guesses) {
  const Submap& submap = back_end_.local();
  const Match tracked = matcher_.match(submap.points, scan.points_base, guesses.front());
  const bool is_good =
      odometry_is_in_doubt_ ? is_certain(tracked) : tracked.score >= params_.search.score_threshold;
  if (is_good || !scan.has_enough_to_search()) {
    T_odom_failed_search_.reset();
    return tracked;
  }
  // A failed search is not repeated before the robot has moved.
  if (T_odom_failed_search_ && !has_moved(*T_odom_failed_search_, scan.T_odom_base)) {
    return tracked;
  }
  ++metrics_.searches;
  const auto found =
      odometry_is_in_doubt_
          ? find_anywhere(scan, guesses, tracked)
          : search_.find_better(matcher_, submap.points, scan.points_base, guesses, tracked);
  if (!found) {
    T_odom_failed_search_ = scan.T_odom_base;
    return tracked;
  }
  ++metrics_.searches_successful;
  T_odom_failed_search_.reset();
  return *found;
}

bool Slam2d::is_certain(const Match& match) const {
  return match.degenerate_directions == 0 && match.score >= params_.doubt.certain_score;
}

// First by branch and bound in the whole local submap, as loops are searched for. Where that is not
// certain, the best of what it finds, `tracked` and what is found near the guesses; nothing when
// none of them fits surely.
std::optional<Match> Slam2d::find_anywhere(const LevelScan& scan,
                                           std::span<const geometry::SE2> guesses,
                                           const Match& tracked) {
  const DoubtParams& params = params_.doubt;
  const PointMap& map = back_end_.local().points;
  std::optional<Match> far;
  const SearchWindow window{guesses.front(), params.search_distance_m, params.search_rotation_rad};
  if (const auto place =
          back_end_.find_in_local(scan.points_base, window, params.min_search_score)) {
    far = matcher_.match(map, scan.points_base, *place);
    if (is_certain(*far)) {
      return far;
    }
  }
  Match best =
      search_.find_better(matcher_, map, scan.points_base, guesses, tracked).value_or(tracked);
  if (far && far->degenerate_directions == 0 && far->score >= best.score) {
    best = *far;
  }
  return best.score >= params.min_score ? std::optional(best) : std::nullopt;
}

PoseUpdate Slam2d::correct_pose(const LevelScan& scan, const Match& match) const {
  PoseUpdate update{.stamp = scan.stamp,
                    .T_map_base = T_map_odom_ * scan.T_odom_base,
                    .inlier_ratio = match.inlier_ratio,
                    .score = match.score,
                    .rms_m = match.rms_m,
                    .quality = classify(scan, match)};
  if (update.quality <= PoseQuality::kPartly) {
    update.T_map_base = back_end_.local().T_map_submap * match.T_map_base;
  }
  return update;
}

// Of the pose in the local submap, and of the submap's own pose at the end of its moment arm.
Eigen::Matrix3d Slam2d::estimate_covariance(const Match& match, const PoseUpdate& update) {
  if (update.quality == PoseQuality::kLost) {
    return Eigen::Matrix3d::Zero();
  }
  const geometry::SE2& T_map_submap = back_end_.local().T_map_submap;
  if (update.quality <= PoseQuality::kPartly) {
    pose_covariance_.match(rotated(match.information, T_map_submap.yaw));
  }
  const Eigen::Matrix3d J =
      moment_arm_jacobian(update.T_map_base.translation() - T_map_submap.translation());
  return pose_covariance_.matrix() + J * back_end_.drift_covariance() * J.transpose();
}

PoseQuality Slam2d::classify(const LevelScan& scan, const Match& match) const {
  if (!scan.has_enough_points()) {
    return PoseQuality::kOdometry;
  }
  const double min_score = odometry_is_in_doubt_
                               ? std::max(params_.doubt.min_score, params_.lost.score_threshold)
                               : params_.lost.score_threshold;
  if (!match.found() || match.score < min_score) {
    return is_lost(scan) ? PoseQuality::kLost : PoseQuality::kOdometry;
  }
  const Eigen::Matrix3d& drift = back_end_.drift_covariance();
  const double max_sigma_m = params_.lost.max_drift_sigma_m;
  const bool has_drifted = std::max(drift(0, 0), drift(1, 1)) > max_sigma_m * max_sigma_m;
  return match.degenerate_directions > 0 || has_drifted ? PoseQuality::kPartly
                                                        : PoseQuality::kTracked;
}

// Of a scan that does not fit the map. What was never in view before fits nowhere, and odometry
// alone is good for a while: in the open, behind obstacles, it is all there is.
bool Slam2d::is_lost(const LevelScan& scan) const {
  const Eigen::Matrix3d& covariance = pose_covariance_.matrix();
  const double max_sigma_m = params_.lost.max_sigma_m;
  return odometry_is_in_doubt_ || moving_points_.contradicts(scan) ||
         std::max(covariance(0, 0), covariance(1, 1)) > max_sigma_m * max_sigma_m;
}

bool Slam2d::has_moved(const geometry::SE2& T_odom_before, const geometry::SE2& T_odom_now) const {
  return distance_m(T_odom_before, T_odom_now) > params_.keyframe.distance_m ||
         std::abs(geometry::angle_difference(T_odom_before.yaw, T_odom_now.yaw)) >
             params_.keyframe.rotation_rad;
}

bool Slam2d::is_keyframe(const PoseUpdate& update, const LevelScan& scan) const {
  if (update.quality == PoseQuality::kLost) {
    return continues_lost(update, scan.T_odom_base);
  }
  return scan.has_enough_points() && has_moved(T_odom_keyframe_, scan.T_odom_base);
}

// Nothing here is on the map: it is continued from odometry, once that is far enough away, or after
// a while: a robot that waits until it is found again would wait for ever.
bool Slam2d::continues_lost(const PoseUpdate& update, const geometry::SE2& T_odom_base) const {
  return distance_m(T_odom_keyframe_, T_odom_base) > params_.lost.distance_m ||
         time::seconds(std::chrono::abs(update.stamp - lost_since_.value_or(update.stamp))) >
             params_.lost.max_s;
}

void Slam2d::add_keyframe(const LevelScan& scan, const Match& match, PoseUpdate& update) {
  Keyframe keyframe{.stamp = scan.stamp,
                    .T_odom_base = scan.T_odom_base,
                    .T_map_base = update.T_map_base,
                    .sensor_origin_base = scan.sensor_origin_base};
  keyframe.points_base.reserve(scan.points_base.size());
  keyframe.normals_base.reserve(scan.points_base.size());
  for (const OrientedPoint& point : scan.points_base) {
    keyframe.points_base.emplace_back(point.p.cast<float>());
    keyframe.normals_base.emplace_back(point.normal.cast<float>());
  }
  if (update.quality == PoseQuality::kLost) {
    const LostParams& lost = params_.lost;
    back_end_.begin_anew({lost.begin_sigma_m, lost.begin_sigma_m, lost.begin_sigma_rad});
    pose_covariance_ = {};  // the robot is where its submap begins
  }
  const geometry::SE2 T_submap_base =
      back_end_.has_local() ? back_end_.local().T_map_submap.inverse() * update.T_map_base
                            : geometry::SE2{};
  const bool is_matched = update.quality <= PoseQuality::kPartly;
  back_end_.add_keyframe(std::move(keyframe), T_submap_base,
                         is_matched ? match.information : Eigen::Matrix3d::Zero());
  update.T_map_base = keyframes().back().T_map_base;
  if (back_end_.dropped()) {
    attach_to_others(*back_end_.dropped());
  }
  T_odom_keyframe_ = scan.T_odom_base;
  update.is_keyframe = true;
}

void Slam2d::correct_odometry(const LevelScan& scan, PoseUpdate& update) {
  T_map_odom_ = update.T_map_base * scan.T_odom_base.inverse();
  T_odom_last_ = scan.T_odom_base;
  update.T_map_odom = T_map_odom_;
  if (update.is_keyframe) {
    pose_guesses_.add_keyframe(T_map_odom_);
  }
}

// Scans of keyframes that are no more follow the keyframe before, or else the one after them.
void Slam2d::attach_to_others(const DroppedKeyframes& dropped) {
  const std::size_t end = dropped.first + dropped.keyframes.size();
  const std::size_t other = std::max<std::size_t>(dropped.first, 1) - 1;
  for (TrackedScan& scan : tracked_scans_) {
    if (scan.keyframe >= end) {
      scan.keyframe -= dropped.keyframes.size();
    } else if (scan.keyframe >= dropped.first) {
      const geometry::SE2 T_map_base =
          dropped.keyframes[scan.keyframe - dropped.first].T_map_base * scan.T_keyframe_base;
      scan.keyframe = other;
      scan.T_keyframe_base = keyframes()[other].T_map_base.inverse() * T_map_base;
    }
  }
}

void Slam2d::record(const PoseUpdate& update) {
  const geometry::SE2 T_keyframe_base = keyframes().back().T_map_base.inverse() * update.T_map_base;
  if (tracked_scans_.size() == static_cast<std::size_t>(params_.path.max_scans)) {
    std::size_t index = 0;
    std::erase_if(tracked_scans_, [&index](const TrackedScan&) { return index++ % 2 == 1; });
    record_every_ *= 2;
  }
  if (metrics_.scans % record_every_ == 0) {
    tracked_scans_.push_back(
        {update.stamp, keyframes().size() - 1, T_keyframe_base, update.T_map_base});
  }
  ++metrics_.scans;
  metrics_.tracked += update.quality == PoseQuality::kTracked ? 1 : 0;
  metrics_.partly += update.quality == PoseQuality::kPartly ? 1 : 0;
  metrics_.odometry_only += update.quality == PoseQuality::kOdometry ? 1 : 0;
  metrics_.lost += update.quality == PoseQuality::kLost ? 1 : 0;
  metrics_.inlier_ratio_sum += update.inlier_ratio;
  metrics_.score_sum += update.score;
}

}  // namespace nodmap::slam2d
