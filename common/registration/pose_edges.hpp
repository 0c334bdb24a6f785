// SPDX-License-Identifier: BSD-3-Clause
// Measured relative poses and their covariances: of (x, y in m, yaw in rad), or of position (m) and
// rotation vector (rad).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/registration/dense_solvers.hpp"
#include "common/registration/pose_graph.hpp"

namespace nodmap::registration {

/// A covariance or information matrix, rotated from its own axes into others, in which its own have
/// the heading `yaw_rad` or the orientation `R`.
[[nodiscard]] Eigen::Matrix3d rotated(const Eigen::Matrix3d& matrix, double yaw_rad);
[[nodiscard]] Matrix6d rotated(const Matrix6d& matrix, const Eigen::Matrix3d& R);

/// Whether a matrix can be the information of an edge: finite, symmetric and, apart from rounding,
/// without a negative eigenvalue. A loop may leave a direction undetermined, for example along a
/// corridor.
[[nodiscard]] bool is_information(const Eigen::Matrix3d& matrix);
[[nodiscard]] bool is_information(const Matrix6d& matrix);

/// The Jacobian of a pose attached to another at the end of a moment arm (2D or 3D), with respect
/// to a small motion of that other.
template <class Vector>
[[nodiscard]] auto moment_arm_jacobian(const Eigen::MatrixBase<Vector>& moment_arm) {
  if constexpr (Vector::RowsAtCompileTime == 2) {
    Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
    J(0, 2) = -moment_arm.y();
    J(1, 2) = moment_arm.x();
    return J;
  } else {
    Matrix6d J = Matrix6d::Identity();
    J.topRightCorner<3, 3>() = -geometry::skew(moment_arm);
    return J;
  }
}

/// The inverse of an information matrix; finite also along degenerate directions, where it is very
/// large. N: 3 or 6.
template <int N>
[[nodiscard]] Eigen::Matrix<double, N, N> covariance_of(
    const Eigen::Matrix<double, N, N>& information);

/// The size of a covariance as one number, m^2: the variance of the position plus that of a point 5
/// m away due to the orientation. N: 3 or 6.
template <int N>
[[nodiscard]] double size_of(const Eigen::Matrix<double, N, N>& covariance);

/// Whether edge `a` is more certain than edge `b`.
template <class Pose>
[[nodiscard]] bool is_surer(const PoseEdge<Pose>& a, const PoseEdge<Pose>& b);

/// The edge along two others, from a to b to c. Their covariances are added, each at the end of its
/// moment arm.
template <class Pose>
[[nodiscard]] PoseEdge<Pose> composed(const PoseEdge<Pose>& a_b, const PoseEdge<Pose>& b_c);

/// The same edge in the opposite direction.
template <class Pose>
[[nodiscard]] PoseEdge<Pose> reversed(const PoseEdge<Pose>& edge);

/// The covariance of the pose of each node relative to that of node `from`, in the axes of map,
/// along the most certain path over `edges`; 1e6 in every direction where there is no path.
template <class Pose>
[[nodiscard]] std::vector<PoseMatrix<Pose>> covariances_from(std::size_t from,
                                                             std::span<const Pose> T_map_nodes,
                                                             std::span<const PoseEdge<Pose>> edges);

}  // namespace nodmap::registration
