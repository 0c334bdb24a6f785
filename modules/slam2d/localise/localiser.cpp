// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/localise/localiser.hpp"

#include "common/geometry/pose_tolerance.hpp"
#include "modules/slam2d/matching/best_place.hpp"

namespace nodmap::slam2d {
namespace {

// A failed search is repeated only after the robot has moved by more than this, or after this time:
// something else may have moved.
constexpr geometry::PoseTolerance kSearched{.distance_m = 0.1, .rotation_rad = 0.2};
constexpr time::Duration kSearchAgain = 1s;
// A scan confirms a place only from this far away, where it shows something else.
constexpr geometry::PoseTolerance kUnconfirmed{.distance_m = 0.5, .rotation_rad = 0.5};

}  // namespace

Localiser::Localiser(const Slam2dParams& params, const KnownMap& map,
                     const std::optional<geometry::SE2>& T_map_start)
    : params_(params),
      map_(map),
      matcher_(params.matcher),
      search_(params.search),
      relocaliser_(params.relocalise, params.matcher),
      T_map_start_(T_map_start),
      doubt_(params.doubt) {}

PoseUpdate Localiser::add_scan(const LevelScan& scan) {
  if (T_map_start_) {
    T_map_odom_ = *T_map_start_ * scan.T_odom_base.inverse();
    T_map_start_.reset();
    state_ = State::kLocated;
  }
  if (scan.odometry_has_restarted) {
    failed_search_.reset();  // the robot may have moved meanwhile
  }
  if (T_odom_last_) {
    covariance_.predict(T_map_odom_.yaw + T_odom_last_->yaw,
                        T_odom_last_->inverse() * scan.T_odom_base);
    begin_doubt_after_gap(scan);
  }
  T_odom_last_ = scan.T_odom_base;
  PoseUpdate update = state_ == State::kLost ? search_whole_map(scan) : track(scan);
  update.T_map_odom = T_map_odom_;
  if (update.state != PoseState::kLost) {
    update.covariance = covariance_.matrix();
  }
  metrics_.scans.count(update.state);
  return update;
}

// Meanwhile the robot may have driven on, or have been carried: its place is to be found again.
// Where odometry has counted the motion, it is as far from its pose by odometry as that is
// uncertain.
void Localiser::begin_doubt_after_gap(const LevelScan& scan) {
  if (scan.has_odometry_gap()) {
    covariance_.lose_track(scan.odometry_gap_s);
  }
  if (state_ == State::kLost || !(scan.has_odometry_gap() || scan.follows_unseen_motion())) {
    return;
  }
  if (scan.has_odometry_gap()) {
    doubt_.begin(scan.odometry_gap_s);
  }
  if (scan.follows_unseen_motion()) {
    doubt_.begin_by_odometry(covariance_.greatest_sigma_m());
  }
  failed_search_.reset();
}

PoseUpdate Localiser::track(const LevelScan& scan) {
  std::optional<Match> match;
  if (scan.has_enough_points()) {
    match = doubt_.is_active() ? match_in_doubt(scan) : this->match(scan);
  }
  PoseUpdate update{.stamp = scan.stamp, .T_map_base = T_map_odom_ * scan.T_odom_base};
  if (!match) {
    follow_odometry(scan, update);
    return update;
  }
  misfit_since_.reset();
  update.T_map_base = match->T_target_base;
  update.inlier_ratio = match->inlier_ratio;
  update.score = match->score;
  update.rms_m = match->rms_m;
  T_map_odom_ = update.T_map_base * scan.T_odom_base.inverse();
  if (!doubt_.is_active()) {  // otherwise the scan fits elsewhere, too
    covariance_.update(match->information);
    confirm(scan);
  }
  const bool is_sure = state_ == State::kLocated && !doubt_.is_active();
  update.state =
      is_sure && match->degenerate_directions == 0 ? PoseState::kTracking : PoseState::kDegraded;
  return update;
}

// Matches from the pose by odometry or, if that does not fit, from poses around it.
std::optional<Match> Localiser::match(const LevelScan& scan) {
  const geometry::SE2 T_map_guess = T_map_odom_ * scan.T_odom_base;
  const Match tracked = matcher_.match(map_.points(), scan.points_base, T_map_guess);
  if (fits(scan, tracked)) {
    failed_search_.reset();
    return tracked;
  }
  if (!is_search_due(scan)) {
    return std::nullopt;
  }
  std::optional<Match> found =
      search_.find_better(matcher_, map_.points(), scan.points_base, {&T_map_guess, 1}, tracked);
  if (found && fits(scan, *found)) {
    failed_search_.reset();
    return found;
  }
  failed_search_ = FailedSearch{scan.stamp, scan.T_odom_base};
  return std::nullopt;
}

// Searches all places in reach. Until the scan fits only one of them, it is matched from odometry.
std::optional<Match> Localiser::match_in_doubt(const LevelScan& scan) {
  const geometry::SE2 T_map_guess = T_map_odom_ * scan.T_odom_base;
  if (is_search_due(scan)) {
    const SearchWindow window =
        doubt_.exceeds_search()
            ? map_.window()
            : SearchWindow{T_map_guess, doubt_.reach_m(), params_.doubt.search_rotation_rad};
    const Relocalisation found = relocaliser_.locate(map_, window, scan);
    if (found.status == Relocalisation::Status::kFound) {
      doubt_.end();
      if (!is_same_place(found.T_map_base, T_map_guess)) {
        take_place(found.T_map_base, scan);
      }
      return match(scan);
    }
    failed_search_ = FailedSearch{scan.stamp, scan.T_odom_base};
  }
  const Match tracked = matcher_.match(map_.points(), scan.points_base, T_map_guess);
  return fits(scan, tracked) ? std::optional(tracked) : std::nullopt;
}

bool Localiser::fits(const LevelScan& scan, const Match& match) const {
  if (!match.found() || match.score < params_.localise.min_score) {
    return false;
  }
  const geometry::SE2& T_map_base = match.T_target_base;
  const WallFit walls = map_.fit_walls(scan.points_base, scan.sensor_origin_base, T_map_base);
  return match.score - walls.through_walls >= params_.localise.min_score;
}

// A place that a search has found, to be confirmed from farther on.
void Localiser::take_place(const geometry::SE2& T_map_base, const LevelScan& scan) {
  state_ = State::kUnconfirmed;
  T_map_odom_ = T_map_base * scan.T_odom_base.inverse();
  T_odom_found_ = scan.T_odom_base;
}

void Localiser::confirm(const LevelScan& scan) {
  if (state_ == State::kUnconfirmed &&
      !geometry::is_within(T_odom_found_, scan.T_odom_base, kUnconfirmed)) {
    state_ = State::kLocated;
  }
}

void Localiser::follow_odometry(const LevelScan& scan, PoseUpdate& update) {
  const bool is_misfit = scan.has_enough_points();
  if (is_misfit) {
    misfit_since_ = misfit_since_.value_or(scan.stamp);
  }
  const bool is_lost = is_misfit ? is_misfit_lost(scan.stamp)
                                 : covariance_.least_sigma_m() > params_.lost.max_sigma_m;
  update.state = is_lost ? PoseState::kLost : PoseState::kOdometry;
  if (is_lost) {
    metrics_.times_lost += state_ == State::kLocated ? 1 : 0;
    state_ = State::kLost;
    misfit_since_.reset();
    failed_search_.reset();
    doubt_.end();
  }
}

// Whether a scan that does not fit makes the robot lost. A place that was never confirmed, or is
// in doubt, is given up at once.
bool Localiser::is_misfit_lost(time::Timestamp stamp) const {
  return state_ == State::kUnconfirmed || doubt_.is_active() ||
         std::chrono::abs(stamp - *misfit_since_) >=
             time::from_seconds(params_.localise.max_misfit_s);
}

PoseUpdate Localiser::search_whole_map(const LevelScan& scan) {
  PoseUpdate update{
      .stamp = scan.stamp, .T_map_base = T_map_odom_ * scan.T_odom_base, .state = PoseState::kLost};
  if (!scan.has_enough_points() || !is_search_due(scan)) {
    return update;
  }
  ++metrics_.searches.made;
  const Relocalisation found = relocaliser_.locate(map_, scan);
  if (found.status != Relocalisation::Status::kFound) {
    failed_search_ = FailedSearch{scan.stamp, scan.T_odom_base};
    return update;
  }
  take_place(found.T_map_base, scan);
  update = track(scan);
  if (state_ == State::kLost) {
    failed_search_ = FailedSearch{scan.stamp, scan.T_odom_base};
  } else {
    ++metrics_.searches.found;
  }
  return update;
}

bool Localiser::is_search_due(const LevelScan& scan) const {
  return !failed_search_ ||
         !geometry::is_within(failed_search_->T_odom_base, scan.T_odom_base, kSearched) ||
         time::is_due(scan.stamp, failed_search_->stamp, kSearchAgain);
}

}  // namespace nodmap::slam2d
