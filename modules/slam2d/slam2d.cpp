// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/slam2d.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "modules/slam2d/best_place.hpp"

namespace nodmap::slam2d {

Slam2d::Slam2d(const Slam2dParams& params)
    : params_(params),
      input_(params.level_scans),
      pose_guesses_(params.people),
      place_search_(params),
      back_end_(params.back_end, params.map, params.matcher),
      doubt_(params.doubt),
      path_(params.path) {}

void Slam2d::change_odometry_frame(const geometry::SE3& T_new_odom_base) {
  const geometry::SE2 T_old_new = input_.change_odometry_frame(T_new_odom_base);
  T_map_odom_ = T_map_odom_ * T_old_new;
  T_first_odom_ = T_first_odom_ * T_old_new;
  T_odom_keyframe_ = T_old_new.inverse() * T_odom_keyframe_;
  T_odom_last_ = T_old_new.inverse() * T_odom_last_;
  moving_points_.change_odometry_frame(T_old_new);
  pose_guesses_.change_odometry_frame(T_old_new);
  place_search_.forget_failure();
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
    if (!doubt_.is_there()) {
      place_search_.forget_failure();  // it was near odometry
    }
    doubt_.begin(all_points->odometry_gap_s);
    pose_covariance_.lose_track(all_points->odometry_gap_s);
  }
  // "These can directly be used as data set D and matched against an incrementally built 2D map" M:
  // the transform that minimises Eq. 3, from the pose by odometry.
  const FoundPlace found = find_place(*all_points, choose_start(*all_points));
  // The same transform corrects the pose.
  PoseUpdate update = correct_pose(*all_points, found);
  update.covariance = estimate_covariance(found.place, update);
  const bool was_in_doubt = doubt_.is_there();
  const bool has_moved_unseen =
      was_in_doubt &&
      params_.keyframe.is_beyond(T_map_odom_ * all_points->T_odom_base, update.T_map_base);
  doubt_.update(update, found.place.is_sure);
  pose_guesses_.add_scan(update.stamp, (T_map_odom_ * T_odom_last_).inverse() * update.T_map_base);
  if (update.state == PoseState::kLost || has_moved_unseen) {
    pose_guesses_.forget_motion();
  }
  if (has_moved_unseen) {
    moving_points_.change_odometry_frame(T_map_odom_.inverse() * update.T_map_base *
                                         all_points->T_odom_base.inverse());
  }
  // "New scan points that do not show a correspondence to already existing points in M are added."
  // That may close a loop, which corrects the pose once more.
  if (is_keyframe(update, *all_points, found)) {
    add_keyframe(found.scan, found.place.match, update);
    moving_points_.add_keyframe(*all_points);
  }
  correct_odometry(*all_points, update);
  // Odometry since the last keyframe does not contain what the robot has moved unseen.
  if (found.has_slipped || (was_in_doubt && !doubt_.is_there())) {
    pose_guesses_.add_keyframe(T_map_odom_, all_points->T_odom_base);
  }
  record(update);
  return update;
}

std::optional<PoseUpdate> Slam2d::begin_map(const LevelScan& scan) {
  if (!scan.has_enough_points()) {
    ++metrics_.scans_without_points;
    return std::nullopt;
  }
  PoseUpdate update{.stamp = scan.stamp,
                    .T_map_base = T_map_odom_ * scan.T_odom_base,
                    .state = PoseState::kTracking};
  add_keyframe(scan, {}, update);
  correct_odometry(scan, update);
  record(update);
  return update;
}

Start Slam2d::choose_start(const LevelScan& all_points) const {
  std::vector<geometry::SE2> guesses = pose_guesses_.guesses(all_points, T_map_odom_, T_odom_last_);
  for (geometry::SE2& guess : guesses) {
    guess = back_end_.local().T_map_submap.inverse() * guess;
  }
  return place_search_.choose_start(back_end_.local(), all_points, std::move(guesses));
}

// If most points lie in space that was free before, either people surround the robot or it is
// elsewhere. While odometry goes on smoothly it cannot be elsewhere.
Slam2d::FoundPlace Slam2d::find_place(const LevelScan& all_points, const Start& start) {
  LevelScan scan = all_points;
  if (start.is_by_odometry && !doubt_.is_there()) {
    scan.points_base = moving_points_.stationary(all_points);
  }
  const bool is_mostly_moving = 2 * scan.points_base.size() < all_points.points_base.size();
  if (is_smooth(all_points, start)) {
    if (const auto place = find_between_people(scan, all_points, start, is_mostly_moving)) {
      hidden_since_.reset();
      return {*place, scan};
    }
    begin_hiding(scan.stamp);
    if (!is_hidden_for_long(scan.stamp)) {
      return {.place = {}, .scan = scan, .is_hidden = true};
    }
  }
  if (is_mostly_moving) {
    scan = all_points;
  }
  const Place place =
      place_search_.find({back_end_, moving_points_, doubt_}, scan, all_points, start);
  // The level scans of a nodding laser are too far apart to give a speed. But whoever hides the
  // view from one of them has passed by the next, and the robot is not elsewhere meanwhile.
  if (all_points.is_of_nod && !doubt_.is_there() && !is_by_odometry(place.match, start) &&
      moving_points_.contradicts(all_points)) {
    begin_hiding(scan.stamp);
    if (!is_hidden_for_long(scan.stamp)) {
      return {.place = {}, .scan = scan, .is_hidden = true};
    }
  }
  const bool has_slipped = hidden_since_.has_value();
  hidden_since_.reset();
  return {.place = place, .scan = scan, .has_slipped = has_slipped};
}

// Whether a scan fits, at the pose by odometry or beside it.
bool Slam2d::is_by_odometry(const Match& match, const Start& start) const {
  return match.found() && match.score >= params_.lost.score_threshold &&
         is_same_place(match.T_target_base, start.guesses.front());
}

bool Slam2d::is_smooth(const LevelScan& scan, const Start& start) const {
  return start.guesses.size() == 1 && !doubt_.is_there() && pose_guesses_.is_fast(scan.stamp);
}

void Slam2d::begin_hiding(time::Timestamp stamp) {
  hidden_since_ = hidden_since_.value_or(stamp);
}

bool Slam2d::is_hidden_for_long(time::Timestamp stamp) const {
  return time::seconds(std::chrono::abs(stamp - *hidden_since_)) >= params_.people.max_hidden_s;
}

// People nearby may hide all but a few walls. The remaining points determine the pose if they fit
// well. A match of all points would follow the people: somebody who walks ahead of a stationary
// robot would shift its pose. `is_mostly_moving`: few points remain.
std::optional<Place> Slam2d::find_between_people(const LevelScan& scan, const LevelScan& all_points,
                                                 const Start& start, bool is_mostly_moving) {
  Place place;
  if (!is_mostly_moving) {
    place = place_search_.find({back_end_, moving_points_, doubt_}, scan, all_points, start);
  } else if (scan.has_enough_to_search()) {
    place.match = place_search_.match(back_end_.local(), scan, start);
    if (place.match.score < params_.doubt.certain_score) {
      return std::nullopt;
    }
  } else {
    return std::nullopt;
  }
  const geometry::SE2& T_map_submap = back_end_.local().T_map_submap;
  const geometry::SE2& T_submap_base = place.match.T_target_base;
  const bool is_odd = place.match.found() &&
                      pose_guesses_.is_beyond_slip(scan, T_map_submap * start.guesses.front(),
                                                   T_map_submap * T_submap_base);
  return is_odd ? std::nullopt : std::optional(place);
}

PoseUpdate Slam2d::correct_pose(const LevelScan& scan, const FoundPlace& found) const {
  const Match& match = found.place.match;
  PoseUpdate update{.stamp = scan.stamp,
                    .T_map_base = T_map_odom_ * scan.T_odom_base,
                    .inlier_ratio = match.inlier_ratio,
                    .score = match.score,
                    .rms_m = match.rms_m,
                    .state = classify(scan, found)};
  if (update.state <= PoseState::kDegraded &&
      (found.place.is_sure || match.score >= params_.doubt.certain_score)) {
    const geometry::SE2& T_submap_base = match.T_target_base;
    update.T_map_base = back_end_.local().T_map_submap * T_submap_base;
  }
  if (found.is_hidden) {  // whoever hides the view may have dragged the pose along
    update.T_map_base = pose_guesses_.since_keyframe(scan);
  }
  return update;
}

// Adds the covariance of the pose in the local submap, and that of the submap's own pose at the end
// of its moment arm.
Eigen::Matrix3d Slam2d::estimate_covariance(const Place& place, const PoseUpdate& update) {
  if (update.state == PoseState::kLost) {
    return Eigen::Matrix3d::Zero();
  }
  const geometry::SE2& T_map_submap = back_end_.local().T_map_submap;
  if (update.state <= PoseState::kDegraded && place.is_sure) {
    pose_covariance_.match(rotated(place.match.information, T_map_submap.yaw));
  }
  const Eigen::Matrix3d J =
      moment_arm_jacobian(update.T_map_base.translation() - T_map_submap.translation());
  return pose_covariance_.matrix() + J * back_end_.drift_covariance() * J.transpose();
}

PoseState Slam2d::classify(const LevelScan& scan, const FoundPlace& found) const {
  const Match& match = found.place.match;
  if (found.is_hidden) {
    return PoseState::kOdometry;
  }
  if (!scan.has_enough_points()) {  // says nothing about the pose
    return pose_covariance_.least_sigma_m() > params_.lost.max_sigma_m ? PoseState::kLost
                                                                       : PoseState::kOdometry;
  }
  const double min_score = doubt_.is_there()
                               ? std::max(params_.doubt.min_score, params_.lost.score_threshold)
                               : params_.lost.score_threshold;
  if (!match.found() || match.score < min_score) {
    return is_lost(scan) ? PoseState::kLost : PoseState::kOdometry;
  }
  const Eigen::Matrix3d& drift = back_end_.drift_covariance();
  const double max_sigma_m = params_.lost.max_drift_sigma_m;
  const bool has_drifted = std::max(drift(0, 0), drift(1, 1)) > max_sigma_m * max_sigma_m;
  return match.degenerate_directions > 0 || has_drifted || !found.place.is_sure
             ? PoseState::kDegraded
             : PoseState::kTracking;
}

// Whether a scan that does not fit the map means that the robot is lost. A scan that shows only
// what was not in view before fits nowhere. Odometry alone suffices for a while, because in the
// open, behind obstacles, there is nothing else.
bool Slam2d::is_lost(const LevelScan& scan) const {
  const Eigen::Matrix3d& covariance = pose_covariance_.matrix();
  const double max_sigma_m = params_.lost.max_sigma_m;
  return doubt_.is_there() || moving_points_.contradicts(scan) ||
         std::max(covariance(0, 0), covariance(1, 1)) > max_sigma_m * max_sigma_m;
}

bool Slam2d::is_keyframe(const PoseUpdate& update, const LevelScan& scan,
                         const FoundPlace& found) const {
  if (!scan.has_enough_points() || found.is_hidden) {
    return false;
  }
  if (doubt_.is_there()) {
    return continues_in_doubt(update, scan.T_odom_base);
  }
  // A nodding laser gives few level scans: one that just misses the distance would leave a gap
  // twice as long.
  return params_.keyframe.is_beyond(T_odom_keyframe_, scan.T_odom_base) ||
         (scan.is_of_nod &&
          distance_m(T_odom_keyframe_, scan.T_odom_base) > params_.keyframe.nodding_distance_m);
}

// The scan fits nowhere in the map, or its place is not sure. The map is continued from odometry
// once the robot is far enough away, or after a while: otherwise it might wait forever to be found.
bool Slam2d::continues_in_doubt(const PoseUpdate& update, const geometry::SE2& T_odom_base) const {
  return distance_m(T_odom_keyframe_, T_odom_base) > params_.lost.distance_m ||
         time::seconds(std::chrono::abs(update.stamp - doubt_.since().value_or(update.stamp))) >
             params_.lost.max_s;
}

void Slam2d::add_keyframe(const LevelScan& scan, const Match& match, PoseUpdate& update) {
  Keyframe keyframe{.stamp = scan.stamp,
                    .T_odom_base = T_first_odom_ * scan.T_odom_base,
                    .T_map_base = update.T_map_base,
                    .sensor_origin_base = scan.sensor_origin_base};
  keyframe.points_base.reserve(scan.points_base.size());
  keyframe.normals_base.reserve(scan.points_base.size());
  for (const OrientedPoint& point : scan.points_base) {
    keyframe.points_base.emplace_back(point.p.cast<float>());
    keyframe.normals_base.emplace_back(point.normal.cast<float>());
  }
  if (doubt_.is_there()) {
    const LostParams& lost = params_.lost;
    back_end_.begin_anew({lost.begin_sigma_m, lost.begin_sigma_m, lost.begin_sigma_rad});
    pose_covariance_ = {};  // the robot is where its submap begins
    doubt_.end();
  }
  const geometry::SE2 T_submap_base =
      back_end_.has_local() ? back_end_.local().T_map_submap.inverse() * update.T_map_base
                            : geometry::SE2{};
  const bool is_matched = update.state <= PoseState::kDegraded;
  back_end_.add_keyframe(std::move(keyframe), T_submap_base,
                         is_matched ? match.information : Eigen::Matrix3d::Zero());
  update.T_map_base = keyframes().back().T_map_base;
  if (back_end_.dropped()) {
    path_.attach_to_others(*back_end_.dropped(), keyframes());
  }
  T_odom_keyframe_ = scan.T_odom_base;
  update.is_keyframe = true;
}

void Slam2d::correct_odometry(const LevelScan& scan, PoseUpdate& update) {
  T_map_odom_ = update.T_map_base * scan.T_odom_base.inverse();
  T_odom_last_ = scan.T_odom_base;
  update.T_map_odom = T_map_odom_;
  if (update.is_keyframe) {
    pose_guesses_.add_keyframe(T_map_odom_, scan.T_odom_base);
  }
}

void Slam2d::record(const PoseUpdate& update) {
  path_.add(update, keyframes());
  metrics_.scans.count(update.state);
  metrics_.inlier_ratio_sum += update.inlier_ratio;
  metrics_.score_sum += update.score;
}

}  // namespace nodmap::slam2d
