// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/loop_closer.hpp"

#include <algorithm>
#include <set>

#include "common/geometry/pose_tolerance.hpp"

namespace nodmap::slam2d {
namespace {

// A match is refused when it ends farther than this from the pose it started from.
constexpr geometry::PoseTolerance kMaxMatchShift{.distance_m = 0.5, .rotation_rad = 0.15};
constexpr double kTrackReachM = 0.4;

// A start pose is more certain than the pose by odometry, for which `params` are chosen.
MatcherParams from_near(MatcherParams params) {
  params.max_correspondence_distance_m =
      std::min(params.max_correspondence_distance_m, kTrackReachM);
  return params;
}

}  // namespace

LoopCloser::LoopCloser(const LoopParams& params, const MatcherParams& matcher)
    : params_(params), matcher_(from_near(matcher)) {}

Loop LoopCloser::loop_of(const LoopQuery& query, const Match& match,
                         const geometry::SE2& T_submap_base_start, double min_inlier_ratio) const {
  Loop loop{.submap = query.submap,
            .keyframe = query.keyframe,
            .T_submap_keyframe = match.T_target_base,
            .information = match.information,
            .score = match.score};
  if (match.found() && match.inlier_ratio >= min_inlier_ratio &&
      match.score >= params_.match.min_score * match.inlier_ratio &&
      geometry::is_within(match.T_target_base, T_submap_base_start, kMaxMatchShift)) {
    loop.state = LoopState::kAccepted;
  }
  return loop;
}

Loop LoopCloser::track(const LoopQuery& query, const Submap& submap,
                       const geometry::SE2& T_submap_base_guess) const {
  return loop_of(query, matcher_.match(submap.points, query.scan, T_submap_base_guess),
                 T_submap_base_guess, params_.match.min_inlier_ratio);
}

Loop LoopCloser::search(const LoopQuery& query, const Submap& submap, const LikelihoodGrid& grid,
                        const SearchWindow& window) const {
  const CorrelativeMatch found =
      match_in_window(grid, points_to_search(query.scan), window,
                      {.min_score = params_.search.min_score,
                       .min_peak_ratio = params_.search.max_runner_up_ratio,
                       .max_peaks = 2});
  if (found.complete && found.peaks.empty()) {
    return {.submap = query.submap, .keyframe = query.keyframe};
  }
  if (!found.is_unique()) {
    return {.submap = query.submap, .keyframe = query.keyframe, .state = LoopState::kAmbiguous};
  }
  const geometry::SE2& T_submap_found = found.peaks.front().T_target_base;
  const Match match = matcher_.match(submap.points, query.scan, T_submap_found);
  Loop loop = loop_of(query, match, T_submap_found, params_.search.min_inlier_ratio);
  // Along a degenerate direction the loop could be anywhere.
  if (match.degenerate_directions > 0) {
    loop.state = LoopState::kLowScore;
  }
  return loop;
}

std::vector<Loop> LoopCloser::add_pending(const Loop& loop, std::span<const Submap> submaps,
                                          std::span<const Keyframe> keyframes) {
  const LoopConsensusParams& params = params_.consensus;
  pending_.push_back(loop);
  std::erase_if(pending_, [&](const Loop& old) {
    return old.keyframe + static_cast<std::size_t>(params.max_age_keyframes) < loop.keyframe;
  });
  // The pose of the newest keyframe in map according to a loop.
  const geometry::SE2& T_map_last = keyframes[loop.keyframe].T_map_base;
  const auto consequence = [&](const Loop& other) {
    return submaps[other.submap].T_map_submap * other.T_submap_keyframe *
           (keyframes[other.keyframe].T_map_base.inverse() * T_map_last);
  };
  std::vector<Loop> consensus;
  std::set<std::size_t> from;
  std::set<std::size_t> against;
  const geometry::SE2 here = consequence(loop);
  for (const Loop& other : pending_) {
    const double distance_m =
        geometry::distance_m(keyframes[other.keyframe].T_map_base, T_map_last);
    if (geometry::is_within(here, consequence(other),
                            {.distance_m = params.max_distance_m + 0.02 * distance_m,
                             .rotation_rad = params.max_rotation_rad})) {
      if (other.is_contradicted) {
        against.insert(other.keyframe);
        continue;
      }
      consensus.push_back(other);
      from.insert(other.keyframe);
    }
  }
  if (from.size() < static_cast<std::size_t>(params.min_keyframes) * (1 + against.size())) {
    return {};
  }
  pending_.clear();
  return consensus;
}

void LoopCloser::drop_submap(std::size_t dropped, std::size_t first_keyframe,
                             std::size_t end_keyframe) {
  std::erase_if(pending_, [&](const Loop& loop) {
    return loop.submap == dropped ||
           (loop.keyframe >= first_keyframe && loop.keyframe < end_keyframe);
  });
  for (Loop& loop : pending_) {
    loop.submap -= loop.submap > dropped ? 1 : 0;
    loop.keyframe -= loop.keyframe >= end_keyframe ? end_keyframe - first_keyframe : 0;
  }
}

}  // namespace nodmap::slam2d
