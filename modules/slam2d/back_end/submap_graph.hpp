// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "common/registration/pose_graph.hpp"
#include "modules/slam2d/back_end/saved_map.hpp"
#include "modules/slam2d/back_end/submap.hpp"
#include "modules/slam2d/back_end/variance_factor.hpp"

namespace nodmap::slam2d {

/// What became of a loop. The values are those of nodmap.pose_graph_t.
enum class LoopState : std::uint8_t {
  kAccepted = 0,
  kAmbiguous = 1,     ///< another place fits as well
  kLowScore = 2,      ///< the scan fits nowhere near, or contradicts what was seen there
  kInconsistent = 3,  ///< with the graph, and too few other keyframes agree so far
  kOutlier = 4,       ///< accepted, but it contradicts the graph and has lost its weight
};

/// The state of the loops between two submaps: of the loop accepted last or, if none was accepted,
/// of the one tried last.
struct SubmapLoop {
  std::size_t from = 0;  ///< indices of submaps
  std::size_t to = 0;
  LoopState state = LoopState::kLowScore;
  double score = 0.0;
};

/// The submaps as nodes of a pose graph: each is joined to the next by odometry and matches, and
/// to others by loops. The only place that knows which loops were accepted or refused; the back end
/// decides which are.
class SubmapGraph {
 public:
  /// Restores the edges of a saved map; must be called before any other is added.
  /// `variance_factor`: as its loops have shown.
  void restore(std::vector<registration::PoseEdge2d> chain, std::span<const SavedMap::Loop> loops,
               const VarianceFactor& variance_factor);

  /// The edge from a submap to the next one.
  void add_chain_edge(const registration::PoseEdge2d& edge);

  /// Adds a loop that is accepted. All loops between the same two submaps are combined into one
  /// edge. `edge`: its information is the inverse covariance of (x, y in m, yaw in rad) in the
  /// frame of `from`; `score`: of its match; `chi_squared`: how far it is from the present poses,
  /// by the covariances of graph and loop as assumed, without the variance factor.
  void add_loop(const registration::PoseEdge2d& edge, double score, double chi_squared);

  /// Records a loop that was tried and is not accepted, or not yet.
  void record_try(const SubmapLoop& loop);

  /// Removes a submap, which must not be the last; the indices of those after it move up by one.
  /// The submaps before and after it are joined directly. Its loops go to the submap to which it is
  /// joined with the greatest certainty, except those that contradict the graph. If it is joined to
  /// that submap by a loop, this loop goes to the submap before or after it. `submaps`: including
  /// the one removed.
  void drop_submap(std::size_t dropped, std::span<const Submap> submaps);

  /// By how much the covariances of all edges are to be multiplied, as loops have shown.
  [[nodiscard]] const VarianceFactor& variance_factor() const { return variance_factor_; }

  /// One entry for each pair of submaps between which a loop was tried.
  [[nodiscard]] std::vector<SubmapLoop> loops(std::span<const Submap> submaps) const;

  /// One edge for each pair of submaps between which loops were accepted.
  [[nodiscard]] std::vector<SavedMap::Loop> accepted_loops() const;

  /// The covariance in map, (x, y in m, yaw in rad), of the pose of each submap relative to that of
  /// submap `local`, along the most certain path.
  [[nodiscard]] std::vector<Eigen::Matrix3d> uncertainties(std::span<const Submap> submaps,
                                                           std::size_t local) const;

  /// The T_map_submap of each submap at which they agree best with all edges. `graduated`: at the
  /// minimum, as PoseGraph2d::optimise() finds it; otherwise two steps towards it.
  [[nodiscard]] std::vector<geometry::SE2> optimised(std::span<const Submap> submaps,
                                                     bool graduated) const;

  /// Counts the changes of edges.
  [[nodiscard]] std::int64_t revision() const { return revision_; }

 private:
  /// The loops between two submaps. The edge of all that were accepted is their mean, weighted by
  /// their information.
  struct LoopSum {
    LoopState state = LoopState::kLowScore;
    double score = 0.0;  ///< of the last one
    geometry::SE2 T_from_to;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d weighted_offset = Eigen::Vector3d::Zero();  ///< from T_from_to

    [[nodiscard]] bool is_accepted() const { return state == LoopState::kAccepted; }
  };

  using Pair = std::pair<std::size_t, std::size_t>;  // the indices of two submaps

  [[nodiscard]] static registration::PoseEdge2d edge_of(const Pair& pair, const LoopSum& loop);
  /// Steps and loops with the covariances that loops have shown to be right.
  [[nodiscard]] std::vector<registration::PoseEdge2d> edges() const;
  /// Whether an edge contradicts the poses of the submaps.
  [[nodiscard]] bool is_outlier(const registration::PoseEdge2d& edge,
                                std::span<const Submap> submaps) const;
  [[nodiscard]] std::vector<SavedMap::Loop> take_loops_of(std::size_t submap);
  /// Adds a loop, or replaces one that is less sure.
  void join(const registration::PoseEdge2d& edge, double score);
  void renumber_without(std::size_t dropped);

  VarianceFactor variance_factor_;
  std::vector<registration::PoseEdge2d> chain_;
  std::map<Pair, LoopSum> loops_;
  std::int64_t revision_ = 0;
};

}  // namespace nodmap::slam2d
