// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cstddef>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"

namespace nodmap::registration {

/// A measured relative pose of two nodes of a graph.
struct PoseEdge2d {
  std::size_t from = 0;
  std::size_t to = 0;
  geometry::SE2 T_from_to;
  /// Inverse covariance of (x, y in m, yaw in rad) of T_from_to, in the frame of `from`.
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
  /// True for a loop closure: it may be wrong, and loses its weight if it contradicts the other
  /// edges.
  bool may_be_wrong = false;
};

/// The residual of an edge at the poses of its nodes: (x, y, yaw) in the frame of `edge.from`.
[[nodiscard]] Eigen::Vector3d residual(const PoseEdge2d& edge, const geometry::SE2& T_map_from,
                                       const geometry::SE2& T_map_to);

/// Robust pose graph in the plane. Computes the poses that fit all measured relative poses best (Lu
/// and Milios 1997), by Gauss-Newton on sparse normal equations (Grisetti et al. 2010).
///
/// Edges that may be wrong are weighted by the kernel of Geman and McClure. The width of the kernel
/// starts where all residuals are inliers and shrinks to the true one (graduated non-convexity:
/// Yang et al. 2020, section IV), so that a correct loop closure is not rejected because the drift
/// is large. The first node is fixed.
class PoseGraph2d {
 public:
  struct Report {
    int iterations = 0;
    bool converged = false;
  };

  std::size_t add_node(const geometry::SE2& T_map_node);
  /// Throws std::invalid_argument for an unknown node, an edge from a node to itself, and numbers
  /// that are not finite.
  void add_edge(const PoseEdge2d& edge);

  /// Moves the nodes to the minimum. `graduated`: starts with the widest kernel; otherwise uses the
  /// true one at once, which takes fewer iterations and suffices if little has changed.
  Report optimise(bool graduated, int max_iterations = 60);

  [[nodiscard]] std::span<const geometry::SE2> nodes() const { return nodes_; }
  [[nodiscard]] std::span<const PoseEdge2d> edges() const { return edges_; }
  /// The weight of an edge at the present poses, 0..1; 1 for one that cannot be wrong.
  [[nodiscard]] double weight(const PoseEdge2d& edge) const;
  /// Squared Mahalanobis length of the residual at the present poses.
  [[nodiscard]] double chi_squared(const PoseEdge2d& edge) const;

 private:
  using Solver = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

  [[nodiscard]] double kernel_weight(const PoseEdge2d& edge, double width) const;
  [[nodiscard]] double widest_kernel() const;
  void build_normal_equations(double width);
  void add_edge_terms(const PoseEdge2d& edge, double weight);
  /// Performs one Gauss-Newton step; returns the largest change of a pose (m or rad).
  double step(double width);

  std::vector<geometry::SE2> nodes_;
  std::vector<PoseEdge2d> edges_;
  std::vector<Eigen::Triplet<double>> terms_;
  Eigen::SparseMatrix<double> hessian_;
  Eigen::VectorXd gradient_;
  Solver solver_;
  bool structure_changed_ = true;
};

}  // namespace nodmap::registration
