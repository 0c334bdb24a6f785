// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/slam2d/back_end/loop_closer.hpp"
#include "modules/slam2d/back_end/saved_map.hpp"
#include "modules/slam2d/back_end/submap_chain.hpp"
#include "modules/slam2d/back_end/submap_graph.hpp"
#include "modules/slam2d/back_end/submap_grids.hpp"
#include "modules/slam2d/matching/scan_matcher.hpp"
#include "modules/slam2d/params.hpp"

namespace nodmap::slam2d {

/// What was done with loops, in counts.
struct LoopMetrics {
  std::int64_t loops_tracked = 0;   ///< found by a match from the pose of the graph
  std::int64_t loops_searched = 0;  ///< accepted by consensus
  std::int64_t searches = 0;
  std::int64_t refused_ambiguous = 0;
  std::int64_t refused_match = 0;
  std::int64_t refused_by_graph = 0;  ///< contradicts the pose of the graph
  std::int64_t refused_by_view = 0;   ///< walls where the other saw free space
  std::int64_t optimisations = 0;
};

/// The loops between the submaps of a chain, and their pose graph: which submaps are tried with
/// each keyframe, and when a loop counts. They can be copied at little cost, so that close() may
/// run on a copy while the original is read.
class SubmapLoops {
 public:
  SubmapLoops(const LoopParams& params, const MatcherParams& matcher)
      : params_(params), closer_(params, matcher) {}

  /// Restores the loops of a saved map. `chain`: its submaps, already restored.
  void restore(const SubmapChain& chain, std::span<const SavedMap::Loop> loops,
               const VarianceFactor& variance_factor);

  /// Adds the edge from the submap before the newest one to that one, and updates
  /// drift_covariance().
  void add_chain_edge(const SubmapChain& chain);

  /// Closes loops between the newest keyframe and older submaps, and optimises the graph when that
  /// is due. Returns the T_map_submap to which each submap is to be moved, or nothing if they stay.
  [[nodiscard]] std::optional<std::vector<geometry::SE2>> close(const SubmapChain& chain,
                                                                SubmapGrids& grids);

  /// Drops a submap, which must not be the last, from the chain and the graph. Returns the
  /// keyframes that no other submap holds.
  DroppedKeyframes drop_submap(std::size_t dropped, SubmapChain& chain);

  [[nodiscard]] const LoopCloser& closer() const { return closer_; }
  [[nodiscard]] const SubmapGraph& graph() const { return graph_; }
  [[nodiscard]] const LoopMetrics& metrics() const { return metrics_; }
  /// See BackEnd::drift_covariance().
  [[nodiscard]] const Eigen::Matrix3d& drift_covariance() const { return drift_covariance_; }

 private:
  void update_uncertainty(const SubmapChain& chain);
  [[nodiscard]] bool is_optimisation_due(const SubmapChain& chain) const;
  [[nodiscard]] std::vector<geometry::SE2> optimise(const SubmapChain& chain);
  [[nodiscard]] Loop track(const SubmapChain& chain, const LoopQuery& query) const;
  [[nodiscard]] Loop search(const SubmapChain& chain, const LoopQuery& query, SubmapGrids& grids,
                            double reach_m, double reach_rad);
  void decide(const SubmapChain& chain, const Loop& loop, bool was_searched);
  void accept_by_consensus(const SubmapChain& chain, Loop loop);
  void accept(const SubmapChain& chain, const Loop& loop);
  void record_try(const SubmapChain& chain, const Loop& loop, LoopState state);
  [[nodiscard]] double chi_squared(const SubmapChain& chain, const Loop& loop) const;

  LoopParams params_;
  LoopCloser closer_;
  SubmapGraph graph_;
  std::size_t keyframes_since_optimised_ = 0;
  bool has_new_loops_ = false;
  bool has_searched_loops_ = false;
  std::vector<Eigen::Matrix3d> uncertainty_;  // of each submap relative to the local one
  double uncertainty_factor_ = 1.0;           // the variance factor in it
  Eigen::Matrix3d drift_covariance_ = Eigen::Matrix3d::Zero();
  LoopMetrics metrics_;
};

}  // namespace nodmap::slam2d
