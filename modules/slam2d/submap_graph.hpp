// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "common/registration/pose_graph.hpp"
#include "modules/slam2d/submap.hpp"
#include "modules/slam2d/variance_factor.hpp"

namespace nodmap::slam2d {

/// The submaps as nodes of a pose graph: each is joined to the next by odometry and matches, and
/// to others by loops.
class SubmapGraph {
 public:
  /// The edge from a submap to the next one.
  void add_chain_edge(const registration::PoseEdge2d& edge) { chain_.push_back(edge); }

  /// A loop. All loops between the same two submaps are combined into one edge. `information`: the
  /// inverse covariance of (x, y in m, yaw in rad) in the frame of `from`.
  void add_loop(std::size_t from, std::size_t to, const geometry::SE2& T_from_to,
                const Eigen::Matrix3d& information);

  /// Removes a submap, which must not be the last; the indices of those after it move up by one.
  /// The submaps before and after it are joined directly. Its loops go to the submap to which it is
  /// joined with the greatest certainty, except those that contradict the graph. If it is joined to
  /// that submap by a loop, this loop goes to the submap before or after it. `submaps`: including
  /// the one removed.
  void drop_submap(std::size_t dropped, std::span<const Submap> submaps);

  /// Whether there is a loop between two submaps.
  [[nodiscard]] bool has_loop(std::size_t from, std::size_t to) const {
    return loops_.contains({from, to});
  }

  /// By how much the covariances of all edges are to be multiplied, as loops have shown.
  [[nodiscard]] VarianceFactor& variance_factor() { return variance_factor_; }
  [[nodiscard]] const VarianceFactor& variance_factor() const { return variance_factor_; }

  /// Whether an edge contradicts the poses of the submaps.
  [[nodiscard]] bool is_outlier(const registration::PoseEdge2d& edge,
                                std::span<const Submap> submaps) const;

  /// The loops, one edge for each pair of submaps.
  [[nodiscard]] std::vector<registration::PoseEdge2d> loops() const;

  /// The covariance in map, (x, y in m, yaw in rad), of the pose of each submap relative to that of
  /// submap `local`, along the most certain path.
  [[nodiscard]] std::vector<Eigen::Matrix3d> uncertainties(std::span<const Submap> submaps,
                                                           std::size_t local) const;

  /// Moves the submaps to where they agree best with all edges. `graduated`: to the minimum, as
  /// PoseGraph2d::optimise() does; otherwise two steps towards it.
  void optimise(std::span<Submap> submaps, bool graduated) const;

 private:
  /// Steps and loops with the covariances that loops have shown to be right.
  [[nodiscard]] std::vector<registration::PoseEdge2d> edges() const;
  [[nodiscard]] std::vector<registration::PoseEdge2d> take_loops_of(std::size_t submap);
  /// Adds a loop, or replaces one that is less sure.
  void join(const registration::PoseEdge2d& edge);
  void renumber_without(std::size_t dropped);

  /// All loops between two submaps, as a mean that is weighted by their information.
  struct LoopSum {
    geometry::SE2 T_from_to;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d weighted_offset = Eigen::Vector3d::Zero();  ///< from T_from_to
  };

  VarianceFactor variance_factor_;
  std::vector<registration::PoseEdge2d> chain_;
  std::map<std::pair<std::size_t, std::size_t>, LoopSum> loops_;
};

}  // namespace nodmap::slam2d
