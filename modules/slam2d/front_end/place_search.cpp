// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/front_end/place_search.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "modules/slam2d/matching/best_place.hpp"

namespace nodmap::slam2d {
namespace {

// A match is certain only if its least information ratio is this many times the limit: in a
// corridor where only a niche or two determine the position along it, a scan fits nearly as well a
// little farther on.
constexpr double kCertainInformationFactor = 2.5;
constexpr std::size_t kMaxPlaces = 8;  // with more places the scan determines nothing

}  // namespace

PlaceSearch::PlaceSearch(const Slam2dParams& params, BackEnd& back_end,
                         const MovingPointFilter& views, const Doubt& doubt)
    : back_end_(back_end),
      views_(views),
      doubt_(doubt),
      matcher_params_(params.matcher),
      search_params_(params.search),
      doubt_params_(params.doubt),
      keyframe_params_(params.keyframe),
      matcher_(params.matcher),
      search_(params.search) {}

StartPoses PlaceSearch::choose_start(const LevelScan& all_points,
                                     std::vector<geometry::SE2> guesses) const {
  StartPoses start{std::move(guesses)};
  if (start.guesses.size() == 1) {
    return start;
  }
  const double min_gain = search_params_.min_gain;
  std::size_t best = 0;
  double best_score = -min_gain;
  for (std::size_t i = 0; i < start.guesses.size(); ++i) {
    const Match match =
        matcher_.match(back_end_.local().points, all_points.points_base, start.guesses[i]);
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

Match PlaceSearch::match(const LevelScan& scan, const StartPoses& start) const {
  return matcher_.match(back_end_.local().points, scan.points_base, start.guesses.front());
}

MatchedPose PlaceSearch::find(const LevelScan& scan, const LevelScan& all_points,
                              const StartPoses& start) {
  const bool is_matched = start.match && scan.points_base.size() == all_points.points_base.size();
  Match tracked = is_matched ? *start.match : match(scan, start);
  if (!doubt_.is_active() && !is_plausible(tracked, all_points, start.guesses)) {
    tracked = {};
  }
  if (is_good(tracked)) {
    T_odom_failed_.reset();
    return {tracked};
  }
  // A failed search is repeated only after the robot has moved.
  const bool has_failed_here =
      T_odom_failed_ && !keyframe_params_.is_beyond(*T_odom_failed_, scan.T_odom_base);
  if (!scan.has_enough_to_search() || has_failed_here) {
    return {tracked, !doubt_.is_active()};
  }
  ++counts_.made;
  std::optional<MatchedPose> found;
  if (doubt_.is_active()) {
    found = find_anywhere(scan, start.guesses, tracked);
  } else {
    found = find_near(scan, all_points, start.guesses, tracked);
  }
  if (!found || !found->is_sure) {
    T_odom_failed_ = scan.T_odom_base;
    return found.value_or(MatchedPose{tracked});
  }
  ++counts_.found;
  T_odom_failed_.reset();
  return *found;
}

// After a scan whose place was not sure, a match near the guess does not suffice, because the guess
// may be wrong.
bool PlaceSearch::is_good(const Match& tracked) const {
  if (!doubt_.is_active()) {
    // Along a degenerate direction a match that does not fit surely may be off by the error of
    // odometry.
    return tracked.score >= (tracked.degenerate_directions > 0 ? doubt_params_.certain_score
                                                               : search_params_.score_threshold);
  }
  return !doubt_.since() && is_certain(tracked);
}

bool PlaceSearch::is_certain(const Match& match) const {
  return match.score >= doubt_params_.certain_score &&
         match.least_information_ratio >=
             kCertainInformationFactor * matcher_params_.min_information_ratio;
}

// A place away from odometry counts only if the scan contradicts what was seen from here. Otherwise
// the scan shows something new, and the other place may merely look alike. But in a fast rotation
// odometry may be late by any angle, and the same place does not look alike at another heading: a
// scan that fits there certainly shows nothing new.
bool PlaceSearch::is_plausible(const Match& match, const LevelScan& all_points,
                               std::span<const geometry::SE2> guesses) const {
  const auto is_here = [&](const geometry::SE2& guess) {
    const geometry::SE2 turned{guess.x, guess.y, match.T_target_base.yaw};
    return is_same_place(match.T_target_base, is_certain(match) ? turned : guess);
  };
  return std::any_of(guesses.begin(), guesses.end(), is_here) || views_.contradicts(all_points);
}

std::optional<MatchedPose> PlaceSearch::find_near(const LevelScan& scan,
                                                  const LevelScan& all_points,
                                                  std::span<const geometry::SE2> guesses,
                                                  const Match& tracked) const {
  const auto better =
      search_.find_better(matcher_, back_end_.local().points, scan.points_base, guesses, tracked);
  return better && is_plausible(*better, all_points, guesses) ? std::optional(MatchedPose{*better})
                                                              : std::nullopt;
}

// Returns the best of all places in reach and of those near the guesses. It is sure if the scan
// fits clearly worse at every other.
MatchedPose PlaceSearch::find_anywhere(const LevelScan& scan,
                                       std::span<const geometry::SE2> guesses,
                                       const Match& tracked) const {
  const DoubtParams& params = doubt_params_;
  const PointMap& map = back_end_.local().points;
  std::vector<Match> matches{
      search_.find_better(matcher_, map, scan.points_base, guesses, tracked).value_or(tracked)};
  const CorrelativeMatch search = back_end_.find_in_local(
      scan.points_base, {guesses.front(), doubt_.search_distance_m(), params.search_rotation_rad},
      params.min_search_score, kMaxPlaces);
  for (const Peak& peak : search.peaks) {
    matches.push_back(matcher_.match(map, scan.points_base, peak.T_target_base));
  }
  std::vector<Peak> places;
  places.reserve(matches.size());
  for (const Match& match : matches) {
    places.push_back({match.T_target_base, match.score});
  }
  const BestPlace best = best_of(places);
  const bool is_complete =
      search.complete && search.peaks.size() < kMaxPlaces && !doubt_.exceeds_search();
  // Along degenerate directions only the search determines the place.
  const bool is_determined =
      matches[best.index].degenerate_directions == 0 ||
      (search.peaks.size() == 1 &&
       is_same_place(places[best.index].T_target_base, search.peaks.front().T_target_base));
  const bool is_sure = is_complete && is_determined && best.score >= params.found_score &&
                       best.is_clear(params.min_misfit_ratio);
  // A place that is not sure replaces the one near the guess only if the scan fits clearly better
  // there.
  const BestPlace better = best_of(std::array{places.front(), places[best.index]});
  return is_sure || (best.score >= params.found_score && better.is_clear(params.min_misfit_ratio))
             ? MatchedPose{matches[best.index], is_sure}
             : MatchedPose{matches.front(), false};
}

}  // namespace nodmap::slam2d
