// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/slam2d.hpp"

#include <algorithm>
#include <utility>

#include "common/registration/pose_edges.hpp"

namespace nodmap::slam2d {
namespace {

// The loops of a keyframe are applied at the first scan this long after it, or with the next
// keyframe if that is sooner. To find them and to optimise the graph of intel takes up to 15 ms.
constexpr time::Duration kLoopTime = 200ms;

}  // namespace

Slam2d::Slam2d(const Slam2dParams& params, std::unique_ptr<Executor> executor)
    : params_(params),
      pose_guesses_(params.people),
      back_end_(params.back_end, params.map, params.matcher),
      doubt_(params.doubt),
      slip_detector_(params, back_end_),
      place_search_(params, back_end_, moving_points_, doubt_),
      pose_finder_(params, place_search_, back_end_, moving_points_, pose_guesses_, doubt_),
      path_(params.path),
      executor_(std::move(executor)) {}

void Slam2d::restore(SavedMap map, TrinaryGrid known,
                     const std::optional<geometry::SE2>& T_map_start) {
  back_end_.restore(std::move(map));
  num_restored_ = keyframes().size();
  finder_ = std::make_unique<Finder>(params_, std::move(known), T_map_start);
}

Metrics Slam2d::metrics() const {
  Metrics metrics = metrics_;
  metrics.searches += place_search_.counts();
  return metrics;
}

const DroppedKeyframes* Slam2d::dropped_keyframes() const {
  return has_applied_loops_ && back_end_.dropped() ? &*back_end_.dropped() : nullptr;
}

std::optional<PoseUpdate> Slam2d::add_scan(const LevelScan& scan) {
  has_applied_loops_ = false;
  if (finder_) {
    return find_in_saved_map(scan);
  }
  if (!back_end_.has_local()) {
    return begin_new_map(scan);
  }
  if (are_loops_due(scan)) {
    apply_loops();
  }
  predict(scan);
  handle_odometry_gap(scan);
  // Steps of the README. 2: data set D.
  const SlipFinding slip = check_slip(scan);
  LevelScan matched = scan;
  if (!slip.points_without_people.empty()) {
    matched.points_base = slip.points_without_people;
  }
  // 3 to 5: "These can directly be used as data set D and matched against an incrementally built 2D
  // map" M: the transform that minimises Eq. 3, from the pose by odometry.
  const StartPoses start = choose_start(matched, slip);
  const FoundPose found = pose_finder_.match_or_search(matched, start);
  // 6: the same transform corrects the pose.
  PoseUpdate update = correct_pose(scan, found);
  record_motion(scan, update);
  const bool is_sure_again = doubt_.update(update, found.pose.is_sure);
  // 7: "New scan points that do not show a correspondence to already existing points in M are
  // added." That begins steps 8 to 12; those of the last keyframe are applied before.
  if (is_keyframe(update, scan, found)) {
    const geometry::SE2 T_new_old = apply_loops();
    update.T_map_base = T_new_old * update.T_map_base;
    update.covariance = registration::rotated(update.covariance, T_new_old.yaw);
    // With the points of somebody ahead: by them the next scan shows that he has walked on.
    add_keyframe(slip.points_without_people.empty() ? found.scan : scan, found.pose.match, update);
    moving_points_.add_keyframe(scan);
  }
  update_map_odom(scan, update);
  // From here on odometry is counted anew: before, it has missed motion that only the match found.
  if (update.is_keyframe || found.odometry_was_wrong || is_sure_again) {
    pose_guesses_.count_odometry_from(T_map_odom_, scan.T_odom_base);
  }
  path_.add(update, keyframes());
  count(update);
  return update;
}

// The map is continued only once the pose is confirmed: a wrong one would spoil it. It is continued
// by the scan that confirms it, because before the next one the robot may be moved unseen. Odometry
// counts as begun in map.
PoseUpdate Slam2d::find_in_saved_map(const LevelScan& scan) {
  PoseUpdate update = finder_->localiser.add_scan(scan);
  metrics_.searches = finder_->localiser.metrics().searches;
  if (update.state == PoseState::kTracking) {
    T_map_odom_ = T_first_odom_ = update.T_map_odom;
    finder_.reset();
    begin_at(scan, update);
  }
  count(update);
  return update;
}

std::optional<PoseUpdate> Slam2d::begin_new_map(const LevelScan& scan) {
  if (!scan.has_enough_points()) {
    moving_points_.add_keyframe(scan);
    return std::nullopt;
  }
  PoseUpdate update{.stamp = scan.stamp,
                    .T_map_base = T_map_odom_ * scan.T_odom_base,
                    .state = PoseState::kTracking};
  begin_at(scan, update);
  count(update);
  return update;
}

// The scan becomes the first keyframe of a submap of its own.
void Slam2d::begin_at(const LevelScan& scan, PoseUpdate& update) {
  moving_points_.add_keyframe(scan);
  add_keyframe(scan, {}, update);
  update_map_odom(scan, update);
  pose_guesses_.count_odometry_from(T_map_odom_, scan.T_odom_base);
  path_.add(update, keyframes());
}

// The pose by odometry becomes less certain.
void Slam2d::predict(const LevelScan& scan) {
  pose_covariance_.predict(T_map_odom_.yaw + T_odom_last_.yaw,
                           T_odom_last_.inverse() * scan.T_odom_base);
}

// After a time without odometry the pose is in doubt: the robot may have moved meanwhile. Where
// odometry has counted the motion, it is as far from its pose by odometry as that is uncertain.
void Slam2d::handle_odometry_gap(const LevelScan& scan) {
  if (scan.follows_unseen_motion()) {
    place_search_.forget_failure();
    doubt_.begin_by_odometry(pose_covariance_.greatest_sigma_m());
  }
  if (scan.odometry_has_restarted) {
    place_search_.forget_failure();
  }
  if (scan.has_odometry_gap()) {
    if (!doubt_.is_active()) {
      place_search_.forget_failure();  // it was near odometry
    }
    doubt_.begin(scan.odometry_gap_s);
    pose_covariance_.lose_track(scan.odometry_gap_s);
  }
}

// Removes slip of the wheels since the last scan from odometry.
SlipFinding Slam2d::check_slip(const LevelScan& scan) {
  const std::vector<geometry::SE2> guesses = pose_guesses_.guesses(scan, T_map_odom_, T_odom_last_);
  // Unless scans are far apart, odometry that contradicts the motion so far hangs, or catches up.
  if (doubt_.is_active() || (guesses.size() > 1 && !scan.is_of_nod)) {
    return {};
  }
  SlipFinding slip = slip_detector_.check(scan, T_map_odom_ * T_odom_last_, guesses.front());
  if (slip.T_map_base) {
    remove_slip(*slip.T_map_base, scan.T_odom_base);
  }
  return slip;
}

// From here on odometry is in a frame in which it has not slipped, and what it measured before
// moves into that frame.
void Slam2d::remove_slip(const geometry::SE2& T_map_base, const geometry::SE2& T_odom_base) {
  const geometry::SE2 T_map_odom = T_map_base * T_odom_base.inverse();
  const geometry::SE2 T_old_new = T_map_odom_.inverse() * T_map_odom;
  moving_points_.move_views(T_old_new);
  T_odom_last_ = T_old_new.inverse() * T_odom_last_;
  T_odom_keyframe_ = T_old_new.inverse() * T_odom_keyframe_;
  T_first_odom_ = T_first_odom_ * T_old_new;
  T_map_odom_ = T_map_odom;
  pose_guesses_.count_odometry_from(T_map_odom_, T_odom_base);
  place_search_.forget_failure();
}

StartPoses Slam2d::choose_start(const LevelScan& scan, const SlipFinding& slip) const {
  std::vector<geometry::SE2> guesses = slip.T_map_base
                                           ? std::vector{*slip.T_map_base}
                                           : pose_guesses_.guesses(scan, T_map_odom_, T_odom_last_);
  for (geometry::SE2& guess : guesses) {
    guess = back_end_.local().T_map_submap.inverse() * guess;
  }
  StartPoses start = place_search_.choose_start(scan, std::move(guesses));
  if (start.guesses.size() == 1) {
    start.match = slip.match;
  }
  return start;
}

PoseUpdate Slam2d::correct_pose(const LevelScan& scan, const FoundPose& found) {
  const Match& match = found.pose.match;
  PoseUpdate update{.stamp = scan.stamp,
                    .T_map_base = T_map_odom_ * scan.T_odom_base,
                    .inlier_ratio = match.inlier_ratio,
                    .score = match.score,
                    .rms_m = match.rms_m,
                    .state = classify(scan, found)};
  if (update.is_matched() && (found.pose.is_sure || match.score >= params_.doubt.certain_score)) {
    const geometry::SE2& T_submap_base = match.T_target_base;
    update.T_map_base = back_end_.local().T_map_submap * T_submap_base;
  }
  if (found.is_hidden) {  // whoever hides the view may have dragged the pose along
    update.T_map_base = pose_guesses_.by_counted_odometry(scan);
  }
  update.covariance = estimate_covariance(found.pose, update);
  return update;
}

// Adds the covariance of the pose in the local submap, and that of the submap's own pose at the end
// of its moment arm.
Eigen::Matrix3d Slam2d::estimate_covariance(const MatchedPose& pose, const PoseUpdate& update) {
  if (update.state == PoseState::kLost) {
    return Eigen::Matrix3d::Zero();
  }
  const geometry::SE2& T_map_submap = back_end_.local().T_map_submap;
  if (update.is_matched() && pose.is_sure) {
    pose_covariance_.update(registration::rotated(pose.match.information, T_map_submap.yaw));
  }
  const Eigen::Matrix3d J = registration::moment_arm_jacobian(update.T_map_base.translation() -
                                                              T_map_submap.translation());
  return pose_covariance_.matrix() + J * back_end_.drift_covariance() * J.transpose();
}

PoseState Slam2d::classify(const LevelScan& scan, const FoundPose& found) const {
  const Match& match = found.pose.match;
  if (found.is_hidden) {
    return PoseState::kOdometry;
  }
  if (!scan.has_enough_points()) {  // says nothing about the pose
    return pose_covariance_.least_sigma_m() > params_.lost.max_sigma_m ? PoseState::kLost
                                                                       : PoseState::kOdometry;
  }
  const double min_score = doubt_.is_active()
                               ? std::max(params_.doubt.min_score, params_.lost.score_threshold)
                               : params_.lost.score_threshold;
  if (!match.found() || match.score < min_score) {
    return is_lost(scan) ? PoseState::kLost : PoseState::kOdometry;
  }
  const Eigen::Matrix3d& drift = back_end_.drift_covariance();
  const double max_sigma_m = params_.lost.max_drift_sigma_m;
  const bool has_drifted = std::max(drift(0, 0), drift(1, 1)) > max_sigma_m * max_sigma_m;
  return match.degenerate_directions > 0 || has_drifted || !found.pose.is_sure
             ? PoseState::kDegraded
             : PoseState::kTracking;
}

// Whether a scan that does not fit the map means that the robot is lost. A scan that shows only
// what was not in view before fits nowhere. Odometry alone suffices for a while, because in the
// open, behind obstacles, there is nothing else.
bool Slam2d::is_lost(const LevelScan& scan) const {
  const Eigen::Matrix3d& covariance = pose_covariance_.matrix();
  const double max_sigma_m = params_.lost.max_sigma_m;
  return doubt_.is_active() || moving_points_.contradicts(scan) ||
         std::max(covariance(0, 0), covariance(1, 1)) > max_sigma_m * max_sigma_m;
}

bool Slam2d::is_keyframe(const PoseUpdate& update, const LevelScan& scan,
                         const FoundPose& found) const {
  if (!scan.has_enough_points() || found.is_hidden) {
    return false;
  }
  if (doubt_.is_active()) {
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

// A motion that odometry has not seen, and that was found in doubt, does not go on. The views of
// earlier keyframes move along with the odom frame, so that scans are compared with them as before.
void Slam2d::record_motion(const LevelScan& scan, const PoseUpdate& update) {
  const bool has_moved_unseen =
      doubt_.is_active() &&
      params_.keyframe.is_beyond(T_map_odom_ * scan.T_odom_base, update.T_map_base);
  pose_guesses_.add_scan(update.stamp, (T_map_odom_ * T_odom_last_).inverse() * update.T_map_base);
  if (update.state == PoseState::kLost || has_moved_unseen) {
    pose_guesses_.forget_motion();
  }
  if (has_moved_unseen) {
    moving_points_.move_views(T_map_odom_.inverse() * update.T_map_base *
                              scan.T_odom_base.inverse());
  }
}

// In log time, so that a replay gives the same poses however long the executor takes.
bool Slam2d::are_loops_due(const LevelScan& scan) const {
  return closing_since_ && std::chrono::abs(scan.stamp - *closing_since_) >= kLoopTime;
}

void Slam2d::finish_loops() {
  has_applied_loops_ = false;
  apply_loops();
}

// Returns by how much they have moved the local submap, in map; the poses since the keyframe, which
// were found in it, move along.
geometry::SE2 Slam2d::apply_loops() {
  if (!closing_since_) {
    return {};
  }
  executor_->wait();
  closing_since_.reset();
  const geometry::SE2 T_map_submap = back_end_.local().T_map_submap;
  back_end_.apply_loops();
  has_applied_loops_ = true;
  const geometry::SE2 T_new_old = back_end_.local().T_map_submap * T_map_submap.inverse();
  T_map_odom_ = T_new_old * T_map_odom_;
  pose_covariance_.rotate(T_new_old.yaw);
  pose_guesses_.move_map(T_new_old);
  if (const std::optional<DroppedKeyframes>& dropped = back_end_.dropped()) {
    path_.attach_to_others(*dropped, keyframes());
    const std::size_t end = dropped->first + dropped->keyframes.size();
    num_restored_ -= std::clamp(num_restored_, dropped->first, end) - dropped->first;
  }
  return T_new_old;
}

// The robot is where that submap begins: there its pose has no error.
void Slam2d::begin_submap_if_in_doubt() {
  if (doubt_.is_active()) {
    const LostParams& lost = params_.lost;
    const double sigma_m = std::max(lost.begin_sigma_m, doubt_.sigma_m());
    back_end_.begin_anew({sigma_m, sigma_m, lost.begin_sigma_rad});
    pose_covariance_ = {};
    doubt_.end();
  }
}

void Slam2d::add_keyframe(const LevelScan& scan, const Match& match, PoseUpdate& update) {
  Keyframe keyframe{.stamp = scan.stamp,
                    .T_odom_base = T_first_odom_ * scan.T_odom_base,
                    .T_map_base = update.T_map_base,
                    .sensor_origin_base = scan.sensor_origin_base};
  set_points(keyframe, scan.points_base);
  begin_submap_if_in_doubt();
  const geometry::SE2 T_submap_base =
      back_end_.has_local() ? back_end_.local().T_map_submap.inverse() * update.T_map_base
                            : geometry::SE2{};
  back_end_.add_keyframe(std::move(keyframe), T_submap_base,
                         update.is_matched() ? match.information : Eigen::Matrix3d::Zero());
  closing_since_ = scan.stamp;
  executor_->start([this] { back_end_.close_loops(); });
  T_odom_keyframe_ = scan.T_odom_base;
  update.is_keyframe = true;
}

void Slam2d::update_map_odom(const LevelScan& scan, PoseUpdate& update) {
  T_map_odom_ = update.T_map_base * scan.T_odom_base.inverse();
  T_odom_last_ = scan.T_odom_base;
  update.T_map_odom = T_map_odom_;
}

void Slam2d::count(const PoseUpdate& update) {
  metrics_.scans.count(update.state);
  metrics_.inlier_ratio_sum += update.inlier_ratio;
  metrics_.score_sum += update.score;
}

}  // namespace nodmap::slam2d
