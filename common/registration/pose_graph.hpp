// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/se3.hpp"
#include "common/registration/dense_solvers.hpp"

namespace nodmap::registration {

/// The properties of a kind of pose that a pose graph needs. A motion of a pose consists of its
/// translation (m) and its rotation (yaw, or a rotation vector, rad) about its own position, in the
/// axes of map.
template <class Pose>
struct PoseSpace;

template <>
struct PoseSpace<geometry::SE2> {
  static constexpr int kDimensions = 3;
  /// 99 % of the residuals of correct edges are below this (chi-squared, three degrees of freedom).
  static constexpr double kInlierChiSquared = 11.345;
  static geometry::SE2 identity() { return {}; }
};

template <>
struct PoseSpace<geometry::SE3> {
  static constexpr int kDimensions = 6;
  static constexpr double kInlierChiSquared = 16.812;  // the same for six degrees of freedom
  static geometry::SE3 identity() { return geometry::SE3::Identity(); }
};

template <class Pose>
using PoseVector = Eigen::Matrix<double, PoseSpace<Pose>::kDimensions, 1>;
template <class Pose>
using PoseMatrix =
    Eigen::Matrix<double, PoseSpace<Pose>::kDimensions, PoseSpace<Pose>::kDimensions>;

/// An edge of the graph: a measured relative pose of two nodes.
template <class Pose>
struct PoseEdge {
  std::size_t from = 0;
  std::size_t to = 0;
  Pose T_from_to = PoseSpace<Pose>::identity();
  /// Inverse covariance of T_from_to in the frame of `from`: of (x, y in m, yaw in rad), or of
  /// position (m) and rotation vector (rad).
  PoseMatrix<Pose> information = PoseMatrix<Pose>::Identity();
  /// True for a loop closure: it may be wrong, and loses its weight if it contradicts the other
  /// edges.
  bool may_be_wrong = false;
};

/// The residual of an edge when its nodes have these poses, in the frame of `edge.from` (m and
/// rad).
[[nodiscard]] Eigen::Vector3d residual(const PoseEdge<geometry::SE2>& edge,
                                       const geometry::SE2& T_map_from,
                                       const geometry::SE2& T_map_to);
[[nodiscard]] Vector6d residual(const PoseEdge<geometry::SE3>& edge,
                                const geometry::SE3& T_map_from, const geometry::SE3& T_map_to);

/// A robust pose graph in the plane (SE2) or in space (SE3). It computes the poses that fit all
/// measured relative poses best (Lu and Milios 1997), by Gauss-Newton steps on sparse normal
/// equations (Grisetti et al. 2010).
///
/// Edges that may be wrong are weighted by the kernel of Geman and McClure. The width of the kernel
/// starts where all residuals are inliers and shrinks to the true one (graduated non-convexity:
/// Yang et al. 2020, section IV), so that a correct loop closure is not rejected because the drift
/// is large. The first node is fixed.
template <class Pose>
class PoseGraph {
 public:
  struct Report {
    int iterations = 0;
    bool converged = false;
  };

  std::size_t add_node(const Pose& T_map_node);
  /// Throws std::invalid_argument for an unknown node, an edge from a node to itself, and numbers
  /// that are not finite.
  void add_edge(const PoseEdge<Pose>& edge);

  /// Moves the nodes to the minimum of the cost. `graduated`: starts with the widest kernel.
  /// Otherwise it uses the true one at once, which takes fewer iterations and suffices if little
  /// has changed.
  Report optimise(bool graduated, int max_iterations = 60);

  [[nodiscard]] std::span<const Pose> nodes() const { return nodes_; }
  [[nodiscard]] std::span<const PoseEdge<Pose>> edges() const { return edges_; }
  /// The weight of an edge at the present poses, 0 to 1; always 1 for an edge that cannot be wrong.
  [[nodiscard]] double weight(const PoseEdge<Pose>& edge) const;
  /// Squared Mahalanobis length of the residual at the present poses.
  [[nodiscard]] double chi_squared(const PoseEdge<Pose>& edge) const;

 private:
  using Solver = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

  /// `chi_squared`: of the edge.
  [[nodiscard]] static double kernel_weight(const PoseEdge<Pose>& edge, double chi_squared,
                                            double width);
  [[nodiscard]] double widest_kernel() const;
  void build_normal_equations(double width);
  /// `error`: the residual of the edge.
  void add_edge_terms(const PoseEdge<Pose>& edge, const PoseVector<Pose>& error, double weight);
  void add_block(std::size_t row, std::size_t column, const PoseMatrix<Pose>& block);
  /// Performs one Gauss-Newton step; returns the largest change of a pose (m or rad), or nothing if
  /// the equations have no finite solution.
  std::optional<double> step(double width);

  std::vector<Pose> nodes_;
  std::vector<PoseEdge<Pose>> edges_;
  std::vector<Eigen::Triplet<double>> terms_;
  Eigen::SparseMatrix<double> hessian_;
  Eigen::VectorXd gradient_;
  Solver solver_;
  bool structure_changed_ = true;
};

using PoseEdge2d = PoseEdge<geometry::SE2>;
using PoseEdge3d = PoseEdge<geometry::SE3>;
using PoseGraph2d = PoseGraph<geometry::SE2>;
using PoseGraph3d = PoseGraph<geometry::SE3>;

}  // namespace nodmap::registration
