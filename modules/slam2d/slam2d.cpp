// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/slam2d.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "modules/slam2d/best_place.hpp"

namespace nodmap::slam2d {
namespace {

// How fast a robot that odometry does not see may drive.
constexpr double kMaxSpeedMPerS = 3.0;
// A little farther along a corridor, in which a niche or two are all that tells the place, a scan
// fits nearly as well.
constexpr double kCertainInformationFactor = 2.5;
constexpr std::size_t kMaxPlaces = 8;  // more mean that the scan tells nothing
// People pass. What has changed for longer is the place itself: the robot was carried.
constexpr time::Duration kMaxHidden = 1s;

}  // namespace

Slam2d::Slam2d(const Slam2dParams& params)
    : params_(params),
      input_(params.level_scans),
      matcher_(params.matcher),
      search_(params.search),
      back_end_(params.back_end, params.map, params.matcher),
      path_(params.path) {}

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
    begin_doubt(all_points->odometry_gap_s);
  }
  const Start start = choose_start(*all_points);
  LevelScan level_scan = *all_points;
  // "These can directly be used as data set D and matched against an incrementally built 2D map" M:
  // the transform that minimises Eq. 3, from the pose by odometry.
  const Place place = find_place(level_scan, start);
  // The same transform corrects the pose.
  PoseUpdate update = correct_pose(*all_points, place);
  update.covariance = estimate_covariance(place, update);
  const bool has_moved_unseen =
      is_in_doubt() && has_moved(T_map_odom_ * all_points->T_odom_base, update.T_map_base);
  update_doubt(update, place.is_sure);
  pose_guesses_.add_scan(update.stamp, (T_map_odom_ * T_odom_last_).inverse() * update.T_map_base);
  if (update.quality == PoseQuality::kLost || has_moved_unseen) {
    pose_guesses_.forget_motion();
  }
  if (has_moved_unseen) {
    moving_points_.change_odometry_frame(T_map_odom_.inverse() * update.T_map_base *
                                         all_points->T_odom_base.inverse());
  }
  // "New scan points that do not show a correspondence to already existing points in M are added."
  // That may close a loop, which corrects the pose once more.
  if (is_keyframe(update, *all_points, place)) {
    add_keyframe(level_scan, place.match, update);
    moving_points_.add_keyframe(*all_points);
  }
  correct_odometry(level_scan, update);
  if (place.has_slipped) {
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
    start.is_smooth = pose_guesses_.is_fast(scan.stamp);
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
      start.match = match;
    }
  }
  std::swap(start.guesses[0], start.guesses[best]);
  start.is_by_odometry = best == 0;
  return start;
}

// Where most of what is measured is in free space, people stand around the robot, or the robot is
// elsewhere. But a robot whose odometry goes on smoothly is not elsewhere.
Slam2d::Place Slam2d::find_place(LevelScan& scan, const Start& start) {
  const LevelScan all_points = scan;
  bool is_elsewhere = false;
  if (start.is_by_odometry && !is_in_doubt()) {
    scan.points_base = moving_points_.stationary(all_points);
    is_elsewhere = 2 * scan.points_base.size() < all_points.points_base.size();
  }
  if (start.is_smooth && !is_in_doubt()) {
    if (const auto place = look_between_people(scan, all_points, start, is_elsewhere)) {
      hidden_since_.reset();
      return *place;
    }
    hidden_since_ = hidden_since_.value_or(scan.stamp);
    if (std::chrono::abs(scan.stamp - *hidden_since_) < kMaxHidden) {
      return {.match = {}, .is_sure = true, .is_hidden = true};
    }
  }
  if (is_elsewhere) {
    scan.points_base = all_points.points_base;
  }
  Place place = match_or_search(scan, all_points, start);
  place.has_slipped = hidden_since_.has_value();
  hidden_since_.reset();
  return place;
}

// Somebody near hides all but a few walls: what is left tells the place if it fits surely. A match
// of all points would follow the people, and who walks ahead of a robot that stands would take it
// along. `is_mostly_moving`: little is left.
std::optional<Slam2d::Place> Slam2d::look_between_people(const LevelScan& scan,
                                                         const LevelScan& all_points,
                                                         const Start& start,
                                                         bool is_mostly_moving) {
  const geometry::SE2& guess = start.guesses.front();
  Place place;
  if (!is_mostly_moving) {
    place = match_or_search(scan, all_points, start);
  } else if (scan.has_enough_to_search()) {
    place.match = matcher_.match(back_end_.local().points, scan.points_base, guess);
    if (place.match.score < params_.doubt.certain_score) {
      return std::nullopt;
    }
  } else {
    return std::nullopt;
  }
  const geometry::SE2& T_map_submap = back_end_.local().T_map_submap;
  const bool is_odd =
      place.match.found() && pose_guesses_.is_beyond_slip(scan, T_map_submap * guess,
                                                          T_map_submap * place.match.T_map_base);
  return is_odd ? std::nullopt : std::optional(place);
}

Slam2d::Place Slam2d::match_or_search(const LevelScan& scan, const LevelScan& all_points,
                                      const Start& start) {
  const std::vector<geometry::SE2>& guesses = start.guesses;
  const bool is_matched = start.match && scan.points_base.size() == all_points.points_base.size();
  const Match tracked =
      is_matched ? *start.match
                 : matcher_.match(back_end_.local().points, scan.points_base, guesses.front());
  if (is_good(tracked)) {
    T_odom_failed_search_.reset();
    return {tracked};
  }
  // A failed search is not repeated before the robot has moved.
  const bool has_failed_here =
      T_odom_failed_search_ && !has_moved(*T_odom_failed_search_, scan.T_odom_base);
  if (!scan.has_enough_to_search() || has_failed_here) {
    return {tracked, !is_in_doubt()};
  }
  ++metrics_.searches;
  std::optional<Place> found;
  if (is_in_doubt()) {
    found = find_anywhere(scan, guesses, tracked);
  } else {
    found = find_near(scan, all_points, guesses, tracked);
  }
  if (!found || !found->is_sure) {
    T_odom_failed_search_ = scan.T_odom_base;
    return found.value_or(Place{tracked});
  }
  ++metrics_.searches_successful;
  T_odom_failed_search_.reset();
  return *found;
}

// Once a scan was not sure, no match near the guess is: that may be as wrong as the guess.
bool Slam2d::is_good(const Match& tracked) const {
  if (!is_in_doubt()) {
    // Along a degenerate direction a match that does not fit surely may be off as odometry is.
    return tracked.score >= (tracked.degenerate_directions > 0 ? params_.doubt.certain_score
                                                               : params_.search.score_threshold);
  }
  return !in_doubt_since_ && tracked.score >= params_.doubt.certain_score &&
         tracked.least_information_ratio >=
             kCertainInformationFactor * params_.matcher.min_information_ratio;
}

// One that is another place than odometry says counts only where the scan contradicts what was seen
// from here: otherwise it shows what is new, and the other place may look like this one.
std::optional<Slam2d::Place> Slam2d::find_near(const LevelScan& scan, const LevelScan& all_points,
                                               std::span<const geometry::SE2> guesses,
                                               const Match& tracked) const {
  const auto better =
      search_.find_better(matcher_, back_end_.local().points, scan.points_base, guesses, tracked);
  if (!better) {
    return std::nullopt;
  }
  const bool is_here = std::any_of(guesses.begin(), guesses.end(), [&](const geometry::SE2& guess) {
    return is_same_place(better->T_map_base, guess);
  });
  return is_here || moving_points_.contradicts(all_points) ? std::optional(Place{*better})
                                                           : std::nullopt;
}

// The best of all places in reach, and of those near the guesses. It is sure where the scan fits
// clearly better than at any other.
Slam2d::Place Slam2d::find_anywhere(const LevelScan& scan, std::span<const geometry::SE2> guesses,
                                    const Match& tracked) {
  const DoubtParams& params = params_.doubt;
  const PointMap& map = back_end_.local().points;
  std::vector<Match> matches{
      search_.find_better(matcher_, map, scan.points_base, guesses, tracked).value_or(tracked)};
  const CorrelativeMatch search = back_end_.find_in_local(
      scan.points_base, {guesses.front(), doubt_m_, params.search_rotation_rad},
      params.min_search_score, kMaxPlaces);
  for (const Peak& peak : search.peaks) {
    matches.push_back(matcher_.match(map, scan.points_base, peak.T_map_base));
  }
  std::vector<Peak> places;
  for (const Match& match : matches) {
    places.push_back({match.T_map_base, match.score});
  }
  const BestPlace best = best_of(places);
  const bool is_complete = search.complete && search.peaks.size() < kMaxPlaces;
  // Along degenerate directions only the search tells the place.
  const bool is_determined =
      matches[best.index].degenerate_directions == 0 ||
      (search.peaks.size() == 1 &&
       is_same_place(places[best.index].T_map_base, search.peaks.front().T_map_base));
  const bool is_sure = is_complete && is_determined && best.score >= params.found_score &&
                       best.is_clear(params.min_misfit_ratio);
  // One that is not sure replaces the place near the guess only where it fits clearly better.
  const BestPlace better = best_of(std::array{places.front(), places[best.index]});
  return is_sure || (best.score >= params.found_score && better.is_clear(params.min_misfit_ratio))
             ? Place{matches[best.index], is_sure}
             : Place{matches.front(), false};
}

// Until then the robot may have been carried, or have driven on.
void Slam2d::begin_doubt(double odometry_gap_s) {
  doubt_m_ = std::min(doubt_m_ + kMaxSpeedMPerS * odometry_gap_s, params_.doubt.search_distance_m);
  pose_covariance_.lose_track(odometry_gap_s);
}

void Slam2d::update_doubt(const PoseUpdate& update, bool is_sure) {
  if (update.quality == PoseQuality::kLost) {
    doubt_m_ = params_.doubt.search_distance_m;
  } else if (update.quality <= PoseQuality::kPartly && is_sure) {
    doubt_m_ = 0.0;
  }
  in_doubt_since_ =
      is_in_doubt() ? std::optional(in_doubt_since_.value_or(update.stamp)) : std::nullopt;
}

PoseUpdate Slam2d::correct_pose(const LevelScan& scan, const Place& place) const {
  const Match& match = place.match;
  PoseUpdate update{.stamp = scan.stamp,
                    .T_map_base = T_map_odom_ * scan.T_odom_base,
                    .inlier_ratio = match.inlier_ratio,
                    .score = match.score,
                    .rms_m = match.rms_m,
                    .quality = classify(scan, place)};
  if (update.quality <= PoseQuality::kPartly &&
      (place.is_sure || match.score >= params_.doubt.certain_score)) {
    update.T_map_base = back_end_.local().T_map_submap * match.T_map_base;
  }
  if (place.is_hidden) {  // who hides the view may have taken the pose along
    update.T_map_base = pose_guesses_.since_keyframe(scan);
  }
  return update;
}

// Of the pose in the local submap, and of the submap's own pose at the end of its moment arm.
Eigen::Matrix3d Slam2d::estimate_covariance(const Place& place, const PoseUpdate& update) {
  if (update.quality == PoseQuality::kLost) {
    return Eigen::Matrix3d::Zero();
  }
  const geometry::SE2& T_map_submap = back_end_.local().T_map_submap;
  if (update.quality <= PoseQuality::kPartly && place.is_sure) {
    pose_covariance_.match(rotated(place.match.information, T_map_submap.yaw));
  }
  const Eigen::Matrix3d J =
      moment_arm_jacobian(update.T_map_base.translation() - T_map_submap.translation());
  return pose_covariance_.matrix() + J * back_end_.drift_covariance() * J.transpose();
}

PoseQuality Slam2d::classify(const LevelScan& scan, const Place& place) const {
  const Match& match = place.match;
  if (!scan.has_enough_points() || place.is_hidden) {
    return PoseQuality::kOdometry;
  }
  const double min_score = is_in_doubt()
                               ? std::max(params_.doubt.min_score, params_.lost.score_threshold)
                               : params_.lost.score_threshold;
  if (!match.found() || match.score < min_score) {
    return is_lost(scan) ? PoseQuality::kLost : PoseQuality::kOdometry;
  }
  const Eigen::Matrix3d& drift = back_end_.drift_covariance();
  const double max_sigma_m = params_.lost.max_drift_sigma_m;
  const bool has_drifted = std::max(drift(0, 0), drift(1, 1)) > max_sigma_m * max_sigma_m;
  return match.degenerate_directions > 0 || has_drifted || !place.is_sure ? PoseQuality::kPartly
                                                                          : PoseQuality::kTracked;
}

// Of a scan that does not fit the map. What was never in view before fits nowhere, and odometry
// alone is good for a while: in the open, behind obstacles, it is all there is.
bool Slam2d::is_lost(const LevelScan& scan) const {
  const Eigen::Matrix3d& covariance = pose_covariance_.matrix();
  const double max_sigma_m = params_.lost.max_sigma_m;
  return is_in_doubt() || moving_points_.contradicts(scan) ||
         std::max(covariance(0, 0), covariance(1, 1)) > max_sigma_m * max_sigma_m;
}

bool Slam2d::has_moved(const geometry::SE2& T_odom_before, const geometry::SE2& T_odom_now) const {
  return distance_m(T_odom_before, T_odom_now) > params_.keyframe.distance_m ||
         std::abs(geometry::angle_difference(T_odom_before.yaw, T_odom_now.yaw)) >
             params_.keyframe.rotation_rad;
}

bool Slam2d::is_keyframe(const PoseUpdate& update, const LevelScan& scan,
                         const Place& place) const {
  if (!scan.has_enough_points() || place.is_hidden) {
    return false;
  }
  if (is_in_doubt()) {
    return continues_in_doubt(update, scan.T_odom_base);
  }
  // Of the few level scans of a nod one that falls a little short would leave a gap twice as long.
  return has_moved(T_odom_keyframe_, scan.T_odom_base) ||
         (scan.is_of_nod &&
          distance_m(T_odom_keyframe_, scan.T_odom_base) > params_.keyframe.nodding_distance_m);
}

// Nothing here is on the map, or it is not sure where: the map is continued from odometry, once
// that is far enough away, or after a while: a robot that waits until it is found again would wait
// for ever.
bool Slam2d::continues_in_doubt(const PoseUpdate& update, const geometry::SE2& T_odom_base) const {
  return distance_m(T_odom_keyframe_, T_odom_base) > params_.lost.distance_m ||
         time::seconds(std::chrono::abs(update.stamp - in_doubt_since_.value_or(update.stamp))) >
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
  if (is_in_doubt()) {
    const LostParams& lost = params_.lost;
    back_end_.begin_anew({lost.begin_sigma_m, lost.begin_sigma_m, lost.begin_sigma_rad});
    pose_covariance_ = {};  // the robot is where its submap begins
    doubt_m_ = 0.0;
    in_doubt_since_.reset();
  }
  const geometry::SE2 T_submap_base =
      back_end_.has_local() ? back_end_.local().T_map_submap.inverse() * update.T_map_base
                            : geometry::SE2{};
  const bool is_matched = update.quality <= PoseQuality::kPartly;
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
  ++metrics_.scans;
  metrics_.tracked += update.quality == PoseQuality::kTracked ? 1 : 0;
  metrics_.partly += update.quality == PoseQuality::kPartly ? 1 : 0;
  metrics_.odometry_only += update.quality == PoseQuality::kOdometry ? 1 : 0;
  metrics_.lost += update.quality == PoseQuality::kLost ? 1 : 0;
  metrics_.inlier_ratio_sum += update.inlier_ratio;
  metrics_.score_sum += update.score;
}

}  // namespace nodmap::slam2d
