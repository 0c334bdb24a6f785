// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/back_end.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/registration/pose_edges.hpp"
#include "modules/slam2d/back_end/polish_graph.hpp"

namespace nodmap::slam2d {
namespace {

using registration::moment_arm_jacobian;
using registration::PoseEdge2d;

// Limits of the work on one keyframe.
constexpr std::size_t kMaxTracked = 2;
constexpr std::size_t kMaxSearches = 2;
constexpr std::size_t kSearchEvery = 3;  // keyframes
// The graph is solved every few keyframes, and less often as it grows, because the time this takes
// is proportional to the number of submaps.
constexpr std::size_t kMinOptimiseEvery = 3;
constexpr std::size_t kSubmapsPerKeyframe = 40;
constexpr double kSigmas = 3.0;
// Where the graph knows a pose to within this, a match finds the place without a search.
constexpr double kCertainDistanceM = 0.35;
constexpr double kCertainRotationRad = 0.1;
// Views from farther apart have less in common, and occlusion hides more.
constexpr double kViewDistanceM = 2.0;

// Standard deviations of a pose found in a saved map, a cell or two: x, y in m, yaw in rad.
const Eigen::Vector3d kFoundSigmas(0.1, 0.1, 0.02);

}  // namespace

BackEnd::BackEnd(const BackEndParams& params, const MapParams& map, const MatcherParams& matcher)
    : params_(params), chain_(params.submap, map), closer_(params.loop, matcher) {}

SavedMap BackEnd::save() const {
  SavedMap map;
  chain_.save(map);
  map.loops = graph_.accepted_loops();
  map.variance_factor = graph_.variance_factor();
  return map;
}

void BackEnd::restore(SavedMap map) {
  const std::vector<SavedMap::Loop> loops = std::move(map.loops);
  const VarianceFactor variance_factor = map.variance_factor;
  chain_.restore(std::move(map));
  std::vector<PoseEdge2d> steps;
  for (std::size_t s = 1; s < submaps().size(); ++s) {
    steps.push_back(chain_.step_to_submap(s));
  }
  graph_.restore(std::move(steps), loops, variance_factor);
  begin_anew(kFoundSigmas);
}

CorrelativeMatch BackEnd::find_in_local(std::span<const OrientedPoint> scan,
                                        const SearchWindow& window, double min_score,
                                        std::size_t max_places) {
  return match_in_window(grids_.of(chain_.local_index(), local()), points_to_search(scan), window,
                         {.min_score = min_score,
                          .min_peak_ratio = params_.loop.search.max_runner_up_ratio,
                          .max_peaks = max_places});
}

void BackEnd::add_keyframe(Keyframe keyframe, const geometry::SE2& T_local_keyframe,
                           const Eigen::Matrix3d& information) {
  const std::size_t num_submaps = submaps().size();
  const bool begins_anew = !has_local();
  const bool is_finished = chain_.add(std::move(keyframe), T_local_keyframe, information);
  if (submaps().size() > std::max<std::size_t>(num_submaps, 1)) {
    graph_.add_chain_edge(chain_.step_to_submap(num_submaps));
  }
  close_loops();
  // One per keyframe; any others follow with the next ones.
  const bool may_be_more = dropped_.has_value();
  dropped_.reset();
  if (is_finished || begins_anew || may_be_more) {
    drop_replaced_submap();
  }
}

void BackEnd::close_loops() {
  ++keyframes_since_optimised_;
  const std::size_t last = keyframes().size() - 1;
  const bool is_search_due = last % kSearchEvery == 0;
  if (is_search_due || uncertainty_.size() != submaps().size()) {
    update_uncertainty();
  }
  const std::size_t end_submap = chain_.end_finished();
  if (end_submap == 0) {
    return;
  }
  const double match_distance_m = params_.loop.match.max_distance_m;
  const std::vector<OrientedPoint> scan = some_points(keyframes()[last]);
  std::size_t tracked = 0;
  std::size_t searched = 0;
  for (const NearbySubmap& near :
       nearest_submaps(submaps(), keyframes(), keyframes()[last].T_map_base.translation(),
                       match_distance_m + params_.loop.search.max_distance_m, end_submap)) {
    const Eigen::Matrix3d& covariance = uncertainty_[near.submap];
    const double reach_m = kSigmas * std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
    const double reach_rad = kSigmas * std::sqrt(covariance(2, 2));
    if (near.distance_m > match_distance_m + reach_m) {
      continue;
    }
    if (reach_m <= kCertainDistanceM && reach_rad <= kCertainRotationRad) {
      if (tracked < kMaxTracked) {
        ++tracked;
        decide(track_loop(near.submap, scan), false);
      }
    } else if (is_search_due && searched < kMaxSearches) {
      ++searched;
      decide(search_loop(near.submap, scan, reach_m, reach_rad), true);
    }
  }
  optimise_if_due();
}

void BackEnd::update_uncertainty() {
  uncertainty_ = graph_.uncertainties(submaps(), chain_.local_index());
  uncertainty_factor_ = graph_.variance_factor().value();
  // The inverse: from submap 0 relative to the local one, to the local one relative to submap 0.
  const Eigen::Matrix3d J = registration::moment_arm_jacobian(
      local().T_map_submap.translation() - submaps()[0].T_map_submap.translation());
  drift_covariance_ = J * uncertainty_[0] * J.transpose();
}

void BackEnd::optimise_if_due() {
  const std::size_t optimise_every =
      std::max(kMinOptimiseEvery, submaps().size() / kSubmapsPerKeyframe);
  if (has_searched_loops_ || (has_new_loops_ && keyframes_since_optimised_ >= optimise_every)) {
    optimise();
  }
}

Loop BackEnd::track_loop(std::size_t submap_index, std::span<const OrientedPoint> scan) {
  const Submap& submap = submaps()[submap_index];
  return closer_.track({submap_index, keyframes().size() - 1, scan}, submap,
                       submap.T_map_submap.inverse() * keyframes().back().T_map_base);
}

Loop BackEnd::search_loop(std::size_t submap_index, std::span<const OrientedPoint> scan,
                          double reach_m, double reach_rad) {
  const Submap& submap = submaps()[submap_index];
  const SearchWindow window{
      submap.T_map_submap.inverse() * keyframes().back().T_map_base,
      std::min(std::max(reach_m, kCertainDistanceM), params_.loop.search.max_distance_m),
      std::min(std::max(reach_rad, kCertainRotationRad), params_.loop.search.max_rotation_rad)};
  ++metrics_.searches;
  return closer_.search({submap_index, keyframes().size() - 1, scan}, submap,
                        grids_.of(submap_index, submap), window);
}

// Decides whether the attempt to recognise the newest keyframe becomes an edge of the graph. A
// place that was searched for, or that contradicts the graph, needs the consensus of several
// keyframes.
void BackEnd::decide(const Loop& loop, bool was_searched) {
  if (loop.state != LoopState::kAccepted) {
    metrics_.refused_ambiguous += loop.state == LoopState::kAmbiguous ? 1 : 0;
    metrics_.refused_match += loop.state == LoopState::kLowScore ? 1 : 0;
    record_try(loop, loop.state);
  } else if (was_searched) {
    accept_by_consensus(loop);
  } else if (chi_squared(loop) > kMaxLoopChiSquared) {
    ++metrics_.refused_by_graph;
    accept_by_consensus(loop);
  } else {
    ++metrics_.loops_tracked;
    accept(loop);
  }
}

// Where places look alike, several keyframes may find the same wrong one. The views of single scans
// then show walls that are missing, or walls in the way.
void BackEnd::accept_by_consensus(Loop loop) {
  loop.is_contradicted = contradicts_views(loop);
  metrics_.refused_by_view += loop.is_contradicted ? 1 : 0;
  // The state until other keyframes agree.
  record_try(loop, loop.is_contradicted ? LoopState::kLowScore : LoopState::kInconsistent);
  for (const Loop& accepted : closer_.add_pending(loop, submaps(), keyframes())) {
    ++metrics_.loops_searched;
    accept(accepted);
    has_searched_loops_ = true;
  }
}

void BackEnd::accept(const Loop& loop) {
  // The loop joins two submaps, because the keyframe is fixed in its own submap.
  PoseEdge2d edge;
  edge.from = loop.submap;
  edge.to = chain_.submap_of(loop.keyframe);
  const geometry::SE2 T_own_keyframe = submaps()[edge.to].pose_of(loop.keyframe);
  edge.T_from_to = loop.T_submap_keyframe * T_own_keyframe.inverse();
  const Eigen::Matrix3d J =
      moment_arm_jacobian(loop.T_submap_keyframe.translation() - edge.T_from_to.translation());
  edge.information = J.transpose() * loop.information * J;
  graph_.add_loop(edge, loop.score, uncertainty_factor_ * chi_squared(loop));
  has_new_loops_ = true;
}

void BackEnd::record_try(const Loop& loop, LoopState state) {
  graph_.record_try({loop.submap, chain_.submap_of(loop.keyframe), state, loop.score});
}

// How far a loop is from the pose of its keyframe, by the covariances of both, which have the same
// variance factor.
double BackEnd::chi_squared(const Loop& loop) const {
  const geometry::SE2& T_map_submap = submaps()[loop.submap].T_map_submap;
  const geometry::SE2 T_submap_keyframe =
      T_map_submap.inverse() * keyframes()[loop.keyframe].T_map_base;
  const Eigen::Vector3d off(
      loop.T_submap_keyframe.x - T_submap_keyframe.x,
      loop.T_submap_keyframe.y - T_submap_keyframe.y,
      geometry::angle_difference(loop.T_submap_keyframe.yaw, T_submap_keyframe.yaw));
  const Eigen::Matrix3d expected =
      registration::rotated(uncertainty_[loop.submap], -T_map_submap.yaw) +
      uncertainty_factor_ * registration::covariance_of(loop.information);
  return off.dot(expected.inverse() * off);
}

bool BackEnd::contradicts_views(const Loop& loop) const {
  const Submap& submap = submaps()[loop.submap];
  const View view = view_of(keyframes()[loop.keyframe]);
  for (std::size_t k = submap.first_keyframe; k < submap.end_keyframe(); ++k) {
    const geometry::SE2 T_other_this = submap.pose_of(k).inverse() * loop.T_submap_keyframe;
    if (T_other_this.translation().norm() < kViewDistanceM &&
        view_of(keyframes()[k]).contradicts(view, T_other_this)) {
      return true;
    }
  }
  return false;
}

void BackEnd::drop_replaced_submap() {
  const int num_newer = params_.submap.max_keyframes_per_place;
  if (num_newer == 0) {
    return;
  }
  if (const auto replaced =
          oldest_replaced_submap(submaps(), keyframes(), chain_.end_finished(), num_newer)) {
    drop_submap(*replaced);
  }
}

void BackEnd::drop_submap(std::size_t dropped) {
  graph_.drop_submap(dropped, submaps());
  dropped_ = chain_.drop_submap(dropped);
  grids_.clear();
  closer_.drop_submap(dropped, dropped_->first, dropped_->first + dropped_->keyframes.size());
  uncertainty_.clear();
  chain_.move_keyframes();
  ++metrics_.submaps_dropped;
}

void BackEnd::optimise() {
  graph_.optimise(chain_.submaps(), has_searched_loops_);
  chain_.move_keyframes();
  ++metrics_.optimisations;
  keyframes_since_optimised_ = 0;
  has_new_loops_ = false;
  has_searched_loops_ = false;
}

void BackEnd::polish() {
  if (params_.polish.rounds > 0 && chain_.straighten_beginning()) {
    ++num_rebuilt_;
  }
  for (int round = 0; round < params_.polish.rounds; ++round) {
    if (round > 0) {
      chain_.rebuild_submaps();
      ++num_rebuilt_;
    }
    const PolishGraph graph{keyframes(), submaps(), chain_.steps()};
    chain_.set_poses(graph.polished(closer_, params_.loop.match.max_distance_m));
  }
}

}  // namespace nodmap::slam2d
