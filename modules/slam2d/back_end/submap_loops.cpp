// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/submap_loops.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/registration/pose_edges.hpp"
#include "common/registration/pose_graph.hpp"
#include "modules/slam2d/scan/view.hpp"

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

// Whether a scan has walls where keyframes of the submap in which it was found saw free space, or
// the other way round.
bool contradicts_views(const SubmapChain& chain, const Loop& loop) {
  const Submap& submap = chain.submaps()[loop.submap];
  const View view = view_of(chain.keyframes()[loop.keyframe]);
  for (std::size_t k = submap.first_keyframe; k < submap.end_keyframe(); ++k) {
    const geometry::SE2 T_other_this = submap.pose_of(k).inverse() * loop.T_submap_keyframe;
    if (T_other_this.translation().norm() < kViewDistanceM &&
        view_of(chain.keyframes()[k]).contradicts(view, T_other_this)) {
      return true;
    }
  }
  return false;
}

}  // namespace

void SubmapLoops::restore(const SubmapChain& chain, std::span<const SavedMap::Loop> loops,
                          const VarianceFactor& variance_factor) {
  std::vector<PoseEdge2d> steps;
  for (std::size_t s = 1; s < chain.submaps().size(); ++s) {
    steps.push_back(chain.step_to_submap(s));
  }
  graph_.restore(std::move(steps), loops, variance_factor);
}

// A submap that begins anew is uncertain from its first scan on.
void SubmapLoops::add_chain_edge(const SubmapChain& chain) {
  graph_.add_chain_edge(chain.step_to_submap(chain.submaps().size() - 1));
  update_uncertainty(chain);
}

std::optional<std::vector<geometry::SE2>> SubmapLoops::close(const SubmapChain& chain,
                                                             SubmapGrids& grids) {
  ++keyframes_since_optimised_;
  const std::vector<Keyframe>& keyframes = chain.keyframes();
  const std::size_t last = keyframes.size() - 1;
  const bool is_search_due = last % kSearchEvery == 0;
  if (is_search_due || uncertainty_.size() != chain.submaps().size()) {
    update_uncertainty(chain);
  }
  const std::size_t end_submap = chain.end_finished();
  if (end_submap == 0) {
    return std::nullopt;
  }
  const double match_distance_m = params_.match.max_distance_m;
  const std::vector<OrientedPoint> scan = some_points(keyframes[last]);
  std::size_t tracked = 0;
  std::size_t searched = 0;
  for (const NearbySubmap& near :
       nearest_submaps(chain.submaps(), keyframes, keyframes[last].T_map_base.translation(),
                       match_distance_m + params_.search.max_distance_m, end_submap)) {
    const Eigen::Matrix3d& covariance = uncertainty_[near.submap];
    const double reach_m = kSigmas * std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
    const double reach_rad = kSigmas * std::sqrt(covariance(2, 2));
    const LoopQuery query{near.submap, last, scan};
    if (near.distance_m > match_distance_m + reach_m) {
      continue;
    }
    if (reach_m <= kCertainDistanceM && reach_rad <= kCertainRotationRad) {
      if (tracked < kMaxTracked) {
        ++tracked;
        decide(chain, track(chain, query), false);
      }
    } else if (is_search_due && searched < kMaxSearches) {
      ++searched;
      decide(chain, search(chain, query, grids, reach_m, reach_rad), true);
    }
  }
  return is_optimisation_due(chain) ? std::optional(optimise(chain)) : std::nullopt;
}

void SubmapLoops::update_uncertainty(const SubmapChain& chain) {
  uncertainty_ = graph_.uncertainties(chain.submaps(), chain.local_index());
  uncertainty_factor_ = graph_.variance_factor().value();
  // The inverse: from submap 0 relative to the local one, to the local one relative to submap 0.
  const Eigen::Matrix3d J = moment_arm_jacobian(chain.local().T_map_submap.translation() -
                                                chain.submaps()[0].T_map_submap.translation());
  drift_covariance_ = J * uncertainty_[0] * J.transpose();
}

bool SubmapLoops::is_optimisation_due(const SubmapChain& chain) const {
  const std::size_t optimise_every =
      std::max(kMinOptimiseEvery, chain.submaps().size() / kSubmapsPerKeyframe);
  return has_searched_loops_ || (has_new_loops_ && keyframes_since_optimised_ >= optimise_every);
}

std::vector<geometry::SE2> SubmapLoops::optimise(const SubmapChain& chain) {
  std::vector<geometry::SE2> T_map_submaps = graph_.optimised(chain.submaps(), has_searched_loops_);
  ++metrics_.optimisations;
  keyframes_since_optimised_ = 0;
  has_new_loops_ = false;
  has_searched_loops_ = false;
  return T_map_submaps;
}

Loop SubmapLoops::track(const SubmapChain& chain, const LoopQuery& query) const {
  const Submap& submap = chain.submaps()[query.submap];
  return closer_.track(
      query, submap, submap.T_map_submap.inverse() * chain.keyframes()[query.keyframe].T_map_base);
}

Loop SubmapLoops::search(const SubmapChain& chain, const LoopQuery& query, SubmapGrids& grids,
                         double reach_m, double reach_rad) {
  const Submap& submap = chain.submaps()[query.submap];
  const SearchWindow window{
      submap.T_map_submap.inverse() * chain.keyframes()[query.keyframe].T_map_base,
      std::min(std::max(reach_m, kCertainDistanceM), params_.search.max_distance_m),
      std::min(std::max(reach_rad, kCertainRotationRad), params_.search.max_rotation_rad)};
  ++metrics_.searches;
  return closer_.search(query, submap, grids.of(query.submap, submap), window);
}

// Decides whether the attempt to recognise the newest keyframe becomes an edge of the graph. A
// place that was searched for, or that contradicts the graph, needs the consensus of several
// keyframes.
void SubmapLoops::decide(const SubmapChain& chain, const Loop& loop, bool was_searched) {
  if (loop.state != LoopState::kAccepted) {
    metrics_.refused_ambiguous += loop.state == LoopState::kAmbiguous ? 1 : 0;
    metrics_.refused_match += loop.state == LoopState::kLowScore ? 1 : 0;
    record_try(chain, loop, loop.state);
  } else if (was_searched) {
    accept_by_consensus(chain, loop);
  } else if (chi_squared(chain, loop) > kMaxLoopChiSquared) {
    ++metrics_.refused_by_graph;
    accept_by_consensus(chain, loop);
  } else {
    ++metrics_.loops_tracked;
    accept(chain, loop);
  }
}

// Where places look alike, several keyframes may find the same wrong one. The views of single scans
// then show walls that are missing, or walls in the way.
void SubmapLoops::accept_by_consensus(const SubmapChain& chain, Loop loop) {
  loop.is_contradicted = contradicts_views(chain, loop);
  metrics_.refused_by_view += loop.is_contradicted ? 1 : 0;
  // The state until other keyframes agree.
  record_try(chain, loop, loop.is_contradicted ? LoopState::kLowScore : LoopState::kInconsistent);
  for (const Loop& accepted : closer_.add_pending(loop, chain.submaps(), chain.keyframes())) {
    ++metrics_.loops_searched;
    accept(chain, accepted);
    has_searched_loops_ = true;
  }
}

void SubmapLoops::accept(const SubmapChain& chain, const Loop& loop) {
  // The loop joins two submaps, because the keyframe is fixed in its own submap.
  PoseEdge2d edge;
  edge.from = loop.submap;
  edge.to = chain.submap_of(loop.keyframe);
  const geometry::SE2 T_own_keyframe = chain.submaps()[edge.to].pose_of(loop.keyframe);
  edge.T_from_to = loop.T_submap_keyframe * T_own_keyframe.inverse();
  const Eigen::Matrix3d J =
      moment_arm_jacobian(loop.T_submap_keyframe.translation() - edge.T_from_to.translation());
  edge.information = J.transpose() * loop.information * J;
  graph_.add_loop(edge, loop.score, uncertainty_factor_ * chi_squared(chain, loop));
  has_new_loops_ = true;
}

void SubmapLoops::record_try(const SubmapChain& chain, const Loop& loop, LoopState state) {
  graph_.record_try({loop.submap, chain.submap_of(loop.keyframe), state, loop.score});
}

// How far a loop is from the pose of its keyframe, by the covariances of both, which have the same
// variance factor.
double SubmapLoops::chi_squared(const SubmapChain& chain, const Loop& loop) const {
  const geometry::SE2& T_map_submap = chain.submaps()[loop.submap].T_map_submap;
  const geometry::SE2 T_submap_keyframe =
      T_map_submap.inverse() * chain.keyframes()[loop.keyframe].T_map_base;
  const Eigen::Vector3d off(
      loop.T_submap_keyframe.x - T_submap_keyframe.x,
      loop.T_submap_keyframe.y - T_submap_keyframe.y,
      geometry::angle_difference(loop.T_submap_keyframe.yaw, T_submap_keyframe.yaw));
  const Eigen::Matrix3d expected =
      registration::rotated(uncertainty_[loop.submap], -T_map_submap.yaw) +
      uncertainty_factor_ * registration::covariance_of(loop.information);
  return off.dot(expected.inverse() * off);
}

DroppedKeyframes SubmapLoops::drop_submap(std::size_t dropped, SubmapChain& chain) {
  graph_.drop_submap(dropped, chain.submaps());
  DroppedKeyframes keyframes = chain.drop_submap(dropped);
  closer_.drop_submap(dropped, keyframes.first, keyframes.first + keyframes.keyframes.size());
  uncertainty_.clear();
  return keyframes;
}

}  // namespace nodmap::slam2d
