// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/loop_closer.hpp"

#include <algorithm>
#include <set>

namespace nodmap::slam2d {
namespace {

constexpr double kSearchCellM = 0.1;
constexpr double kGridRangeM = 25.0;
constexpr std::size_t kCachedGrids = 24;
// A match is refused when it ends farther than this from the pose it started from.
constexpr double kMaxMatchShiftM = 0.5;
constexpr double kMaxMatchShiftRad = 0.15;
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

Loop LoopCloser::loop_of(const Match& match, const geometry::SE2& T_submap_base_start,
                         double min_inlier_ratio) const {
  const geometry::SE2& T_submap_base = match.T_target_base;
  Loop loop;
  loop.score = match.score;
  loop.T_submap_keyframe = T_submap_base;
  loop.information = match.information;
  if (match.found() && match.inlier_ratio >= min_inlier_ratio &&
      match.score >= params_.match.min_score * match.inlier_ratio &&
      geometry::distance_m(T_submap_base, T_submap_base_start) <= kMaxMatchShiftM &&
      geometry::rotation_rad(T_submap_base, T_submap_base_start) <= kMaxMatchShiftRad) {
    loop.state = LoopState::kAccepted;
  }
  return loop;
}

Loop LoopCloser::track(const Submap& submap, std::span<const OrientedPoint> scan,
                       const geometry::SE2& T_submap_base_guess) const {
  return loop_of(matcher_.match(submap.points, scan, T_submap_base_guess), T_submap_base_guess,
                 params_.match.min_inlier_ratio);
}

const LikelihoodGrid& LoopCloser::grid_of(std::size_t submap_index, const Submap& submap) {
  ++uses_;
  const std::size_t num_points = submap.points.points().size();
  if (const auto found = grids_.find(submap_index);
      found != grids_.end() && found->second.num_points == num_points) {
    found->second.last_use = uses_;
    return found->second.grid;
  }
  if (grids_.size() >= kCachedGrids) {
    grids_.erase(std::min_element(grids_.begin(), grids_.end(), [](const auto& a, const auto& b) {
      return a.second.last_use < b.second.last_use;
    }));
  }
  std::vector<Eigen::Vector2d> points;
  points.reserve(num_points);
  for (const MapPoint& point : submap.points.points()) {
    points.push_back(point.point.p);
  }
  grids_.erase(submap_index);
  return grids_
      .emplace(submap_index,
               CachedGrid{num_points, uses_, LikelihoodGrid(points, kSearchCellM, kGridRangeM)})
      .first->second.grid;
}

CorrelativeMatch LoopCloser::find(std::size_t submap_index, const Submap& submap,
                                  std::span<const OrientedPoint> scan, const SearchWindow& window,
                                  double min_score, std::size_t max_places) {
  return match_in_window(grid_of(submap_index, submap), points_to_search(scan), window,
                         {.min_score = min_score,
                          .min_peak_ratio = params_.search.max_runner_up_ratio,
                          .max_peaks = max_places});
}

Loop LoopCloser::search(std::size_t submap_index, const Submap& submap,
                        std::span<const OrientedPoint> scan, const SearchWindow& window) {
  const CorrelativeMatch found =
      find(submap_index, submap, scan, window, params_.search.min_score, 2);
  if (found.complete && found.peaks.empty()) {
    return {};
  }
  if (!found.is_unique()) {
    return {.state = LoopState::kAmbiguous};
  }
  const geometry::SE2& T_submap_found = found.peaks.front().T_target_base;
  const Match match = matcher_.match(submap.points, scan, T_submap_found);
  Loop loop = loop_of(match, T_submap_found, params_.search.min_inlier_ratio);
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
    const geometry::SE2 there = consequence(other);
    if (geometry::distance_m(here, there) < params.max_distance_m + 0.02 * distance_m &&
        geometry::rotation_rad(here, there) < params.max_rotation_rad) {
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
  grids_.clear();  // they are built again when needed
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
