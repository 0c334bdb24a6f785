// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/pose_edges.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace nodmap::registration {
namespace {

using geometry::SE2;
using geometry::SE3;

double orientation(const SE2& pose) {
  return pose.yaw;
}

Eigen::Matrix3d orientation(const SE3& pose) {
  return pose.linear();
}

// The inverse of covariance_of(): directions that were unknown are unknown again.
template <int N>
Eigen::Matrix<double, N, N> information_of(const Eigen::Matrix<double, N, N>& covariance) {
  constexpr double kUnknown = 1e4;  // covariance_of() gives 1e6 for a degenerate direction
  const auto [values, vectors] = eigensystem(covariance);
  Eigen::Matrix<double, N, 1> information = Eigen::Matrix<double, N, 1>::Zero();
  for (int k = 0; k < N; ++k) {
    const double variance = values[k];
    information[k] = variance < kUnknown ? 1.0 / std::max(variance, 1e-9) : 0.0;
  }
  return vectors * information.asDiagonal() * vectors.transpose();
}

// One step away from a node: along an edge, in either direction.
template <class Pose>
struct Neighbour {
  std::size_t node;
  PoseMatrix<Pose> covariance_map;  // of the step, axes of map
};

// Of each node.
template <class Pose>
std::vector<std::vector<Neighbour<Pose>>> neighbours(std::span<const Pose> T_map_nodes,
                                                     std::span<const PoseEdge<Pose>> edges) {
  std::vector<std::vector<Neighbour<Pose>>> all(T_map_nodes.size());
  for (const PoseEdge<Pose>& edge : edges) {
    const Pose& T_map_from = T_map_nodes[edge.from];
    const PoseMatrix<Pose> covariance =
        rotated(covariance_of(edge.information), orientation(T_map_from));
    all[edge.from].push_back({edge.to, covariance});
    // Seen from `to`, the orientation of the step moves `from`.
    const PoseMatrix<Pose> J =
        moment_arm_jacobian(T_map_from.translation() - T_map_nodes[edge.to].translation());
    all[edge.to].push_back({edge.from, J * covariance * J.transpose()});
  }
  return all;
}

template <int N>
bool can_be_information(const Eigen::Matrix<double, N, N>& matrix) {
  constexpr double kAsymmetry = 1e-6;
  constexpr double kRounding = 1e-9;
  if (!matrix.allFinite() || !matrix.isApprox(matrix.transpose(), kAsymmetry)) {
    return false;
  }
  const auto values = eigensystem(matrix).values;
  return values[0] >= -kRounding * std::abs(values[N - 1]);
}

}  // namespace

bool is_information(const Eigen::Matrix3d& matrix) {
  return can_be_information(matrix);
}

bool is_information(const Matrix6d& matrix) {
  return can_be_information(matrix);
}

Eigen::Matrix3d rotated(const Eigen::Matrix3d& matrix, double yaw_rad) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = SE2{0.0, 0.0, yaw_rad}.rotation();
  return turn * matrix * turn.transpose();
}

Matrix6d rotated(const Matrix6d& matrix, const Eigen::Matrix3d& R) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = R;
  turn.bottomRightCorner<3, 3>() = R;
  return turn * matrix * turn.transpose();
}

template <int N>
Eigen::Matrix<double, N, N> covariance_of(const Eigen::Matrix<double, N, N>& information) {
  using Matrix = Eigen::Matrix<double, N, N>;
  return inverse(Matrix(information + 1e-6 * Matrix::Identity()));
}

template <int N>
double size_of(const Eigen::Matrix<double, N, N>& covariance) {
  constexpr double kMomentArmM = 5.0;
  constexpr int kTranslations = N == 3 ? 2 : 3;
  constexpr int kRotations = N - kTranslations;
  return covariance.template topLeftCorner<kTranslations, kTranslations>().trace() +
         kMomentArmM * kMomentArmM *
             covariance.template bottomRightCorner<kRotations, kRotations>().trace();
}

template <class Pose>
bool is_surer(const PoseEdge<Pose>& a, const PoseEdge<Pose>& b) {
  return size_of(covariance_of(a.information)) < size_of(covariance_of(b.information));
}

template <class Pose>
PoseEdge<Pose> composed(const PoseEdge<Pose>& a_b, const PoseEdge<Pose>& b_c) {
  PoseEdge<Pose> edge{.from = a_b.from,
                      .to = b_c.to,
                      .T_from_to = a_b.T_from_to * b_c.T_from_to,
                      .may_be_wrong = a_b.may_be_wrong || b_c.may_be_wrong};
  const PoseMatrix<Pose> J =
      moment_arm_jacobian(edge.T_from_to.translation() - a_b.T_from_to.translation());
  edge.information = information_of(
      PoseMatrix<Pose>(J * covariance_of(a_b.information) * J.transpose() +
                       rotated(covariance_of(b_c.information), orientation(a_b.T_from_to))));
  return edge;
}

template <class Pose>
PoseEdge<Pose> reversed(const PoseEdge<Pose>& edge) {
  PoseEdge<Pose> back{.from = edge.to,
                      .to = edge.from,
                      .T_from_to = edge.T_from_to.inverse(),
                      .may_be_wrong = edge.may_be_wrong};
  // A motion of `from`, as `to` sees it.
  const PoseMatrix<Pose> J = moment_arm_jacobian(-edge.T_from_to.translation());
  const PoseMatrix<Pose> covariance = J * covariance_of(edge.information) * J.transpose();
  back.information = rotated(information_of(covariance), orientation(back.T_from_to));
  return back;
}

// Dijkstra's algorithm by the size of the covariance (Olson 2008, section 4.2.3). Paths are not
// fused, so no covariance comes out too small.
template <class Pose>
std::vector<PoseMatrix<Pose>> covariances_from(std::size_t from, std::span<const Pose> T_map_nodes,
                                               std::span<const PoseEdge<Pose>> edges) {
  using Matrix = PoseMatrix<Pose>;
  const auto all = neighbours(T_map_nodes, edges);
  std::vector<Matrix> found(all.size(), Matrix::Identity() * 1e6);
  std::vector<double> size(all.size(), std::numeric_limits<double>::infinity());
  std::vector<bool> done(all.size(), false);
  std::vector<std::pair<double, std::size_t>> open;  // a heap, the smallest on top
  const auto reach = [&](std::size_t node, const Matrix& covariance) {
    if (size_of(covariance) < size[node]) {
      size[node] = size_of(covariance);
      found[node] = covariance;
      open.emplace_back(size[node], node);
      std::ranges::push_heap(open, std::greater<>());
    }
  };
  reach(from, Matrix::Zero());
  while (!open.empty()) {
    std::ranges::pop_heap(open, std::greater<>());
    const std::size_t at = open.back().second;
    open.pop_back();
    if (done[at]) {
      continue;
    }
    done[at] = true;
    for (const Neighbour<Pose>& next : all[at]) {
      const Matrix J =
          moment_arm_jacobian(T_map_nodes[next.node].translation() - T_map_nodes[at].translation());
      reach(next.node, J * found[at] * J.transpose() + next.covariance_map);
    }
  }
  return found;
}

template Eigen::Matrix3d covariance_of(const Eigen::Matrix3d&);
template Matrix6d covariance_of(const Matrix6d&);
template double size_of(const Eigen::Matrix3d&);
template double size_of(const Matrix6d&);
template bool is_surer(const PoseEdge2d&, const PoseEdge2d&);
template bool is_surer(const PoseEdge3d&, const PoseEdge3d&);
template PoseEdge2d composed(const PoseEdge2d&, const PoseEdge2d&);
template PoseEdge3d composed(const PoseEdge3d&, const PoseEdge3d&);
template PoseEdge2d reversed(const PoseEdge2d&);
template PoseEdge3d reversed(const PoseEdge3d&);
template std::vector<Eigen::Matrix3d> covariances_from(std::size_t, std::span<const SE2>,
                                                       std::span<const PoseEdge2d>);
template std::vector<Matrix6d> covariances_from(std::size_t, std::span<const SE3>,
                                                std::span<const PoseEdge3d>);

}  // namespace nodmap::registration
