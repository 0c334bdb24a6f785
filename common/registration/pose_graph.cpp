// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/pose_graph.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace nodmap::registration {
namespace {

using geometry::SE2;
using geometry::SE3;
using geometry::skew;

constexpr double kWidthDecay = 0.4;  // of the kernel, from one stage to the next
constexpr double kConverged = 1e-5;  // m or rad
// Keeps the equations solvable if a node has no edge; equals a standard deviation of 1 km.
constexpr double kDamping = 1e-6;

bool is_finite(const SE2& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.yaw);
}

bool is_finite(const SE3& pose) {
  return pose.matrix().allFinite();
}

SE2 moved(const SE2& pose, const Eigen::Vector3d& motion) {
  return {pose.x + motion.x(), pose.y + motion.y(),
          geometry::normalize_angle(pose.yaw + motion.z())};
}

SE3 moved(const SE3& pose, const PoseVector<SE3>& motion) {
  SE3 result = pose;
  result.translation() += motion.head<3>();
  // Renormalised, because rounding errors add up over a thousand products.
  result.linear() = Eigen::Quaterniond(geometry::rotation_of(motion.tail<3>()) * pose.linear())
                        .normalized()
                        .toRotationMatrix();
  return result;
}

// Derivatives of the residual with respect to motions of the two nodes.
template <class Pose>
struct Jacobians {
  PoseMatrix<Pose> from;
  PoseMatrix<Pose> to;
};

Jacobians<SE2> jacobians(const PoseEdge2d&, const SE2& from, const SE2& to) {
  const Eigen::Matrix2d R_from_map = from.rotation().transpose();
  const Eigen::Vector2d offset = R_from_map * (to.translation() - from.translation());
  Eigen::Matrix3d J_from = -Eigen::Matrix3d::Identity();
  J_from.topLeftCorner<2, 2>() = -R_from_map;
  J_from(0, 2) = offset.y();
  J_from(1, 2) = -offset.x();
  Eigen::Matrix3d J_to = Eigen::Matrix3d::Identity();
  J_to.topLeftCorner<2, 2>() = R_from_map;
  return {J_from, J_to};
}

Jacobians<SE3> jacobians(const PoseEdge3d& edge, const SE3& from, const SE3& to) {
  const Eigen::Matrix3d R_from_map = from.linear().transpose();
  const Eigen::Vector3d moment_arm = to.translation() - from.translation();
  // Inverse of the left Jacobian of SO(3) at the residual, to second order.
  const Eigen::Matrix3d turn = skew(residual(edge, from, to).tail<3>());
  const Eigen::Matrix3d R =
      (Eigen::Matrix3d::Identity() - 0.5 * turn + turn * turn / 12.0) * R_from_map;
  Jacobians<SE3> J{PoseMatrix<SE3>::Zero(), PoseMatrix<SE3>::Zero()};
  J.from.topLeftCorner<3, 3>() = -R_from_map;
  J.from.topRightCorner<3, 3>() = R_from_map * skew(moment_arm);
  J.from.bottomRightCorner<3, 3>() = -R;
  J.to.topLeftCorner<3, 3>() = R_from_map;
  J.to.bottomRightCorner<3, 3>() = R;
  return J;
}

}  // namespace

Eigen::Vector3d residual(const PoseEdge2d& edge, const SE2& T_map_from, const SE2& T_map_to) {
  const SE2 T_from_to = T_map_from.inverse() * T_map_to;
  return {T_from_to.x - edge.T_from_to.x, T_from_to.y - edge.T_from_to.y,
          geometry::angle_difference(T_from_to.yaw, edge.T_from_to.yaw)};
}

Vector6d residual(const PoseEdge3d& edge, const SE3& T_map_from, const SE3& T_map_to) {
  const SE3 T_from_to = T_map_from.inverse() * T_map_to;
  Vector6d error;
  error << T_from_to.translation() - edge.T_from_to.translation(),
      geometry::rotation_vector(T_from_to.linear() * edge.T_from_to.linear().transpose());
  return error;
}

template <class Pose>
std::size_t PoseGraph<Pose>::add_node(const Pose& T_map_node) {
  nodes_.push_back(T_map_node);
  structure_changed_ = true;
  return nodes_.size() - 1;
}

template <class Pose>
void PoseGraph<Pose>::add_edge(const PoseEdge<Pose>& edge) {
  if (edge.from >= nodes_.size() || edge.to >= nodes_.size() || edge.from == edge.to) {
    throw std::invalid_argument("pose graph: an edge needs two nodes of the graph");
  }
  if (!is_finite(edge.T_from_to) || !edge.information.allFinite()) {
    throw std::invalid_argument("pose graph: an edge that is not finite");
  }
  edges_.push_back(edge);
  structure_changed_ = true;
}

template <class Pose>
double PoseGraph<Pose>::chi_squared(const PoseEdge<Pose>& edge) const {
  const PoseVector<Pose> error = residual(edge, nodes_[edge.from], nodes_[edge.to]);
  return error.dot(edge.information * error);
}

template <class Pose>
double PoseGraph<Pose>::weight(const PoseEdge<Pose>& edge) const {
  return kernel_weight(edge, chi_squared(edge), 1.0);
}

template <class Pose>
double PoseGraph<Pose>::kernel_weight(const PoseEdge<Pose>& edge, double chi_squared,
                                      double width) {
  if (!edge.may_be_wrong) {
    return 1.0;
  }
  const double scale = width * PoseSpace<Pose>::kInlierChiSquared;
  const double root = scale / (scale + chi_squared);
  return root * root;
}

template <class Pose>
double PoseGraph<Pose>::widest_kernel() const {
  double largest = 0.0;
  for (const PoseEdge<Pose>& edge : edges_) {
    largest = std::max(largest, edge.may_be_wrong ? chi_squared(edge) : 0.0);
  }
  // Twice the largest residual, as Yang et al. (2020) begin: nearly convex for all of them.
  return std::max(1.0, 2.0 * largest / PoseSpace<Pose>::kInlierChiSquared);
}

template <class Pose>
typename PoseGraph<Pose>::Report PoseGraph<Pose>::optimise(bool graduated, int max_iterations) {
  Report report;
  if (nodes_.size() < 2) {
    report.converged = true;
    return report;
  }
  double width = graduated ? widest_kernel() : 1.0;
  while (report.iterations < max_iterations && !report.converged) {
    const std::optional<double> change = step(width);
    ++report.iterations;
    if (!change && width <= 1.0) {
      break;  // repeating the step would fail again
    }
    report.converged = change && width <= 1.0 && *change < kConverged;
    width = std::max(1.0, kWidthDecay * width);
  }
  return report;
}

template <class Pose>
void PoseGraph<Pose>::build_normal_equations(double width) {
  const auto unknowns =
      static_cast<Eigen::Index>(PoseSpace<Pose>::kDimensions * (nodes_.size() - 1));
  terms_.clear();
  gradient_ = Eigen::VectorXd::Zero(unknowns);
  for (Eigen::Index k = 0; k < unknowns; ++k) {
    terms_.emplace_back(static_cast<int>(k), static_cast<int>(k), kDamping);
  }
  for (const PoseEdge<Pose>& edge : edges_) {
    const PoseVector<Pose> error = residual(edge, nodes_[edge.from], nodes_[edge.to]);
    add_edge_terms(edge, error, kernel_weight(edge, error.dot(edge.information * error), width));
  }
  hessian_.resize(unknowns, unknowns);
  hessian_.setFromTriplets(terms_.begin(), terms_.end());
}

template <class Pose>
void PoseGraph<Pose>::add_block(std::size_t row, std::size_t column,
                                const PoseMatrix<Pose>& block) {
  if (row < column) {
    return;  // the lower half is enough
  }
  for (int r = 0; r < PoseSpace<Pose>::kDimensions; ++r) {
    for (int c = 0; c < PoseSpace<Pose>::kDimensions; ++c) {
      terms_.emplace_back(static_cast<int>(row) + r, static_cast<int>(column) + c, block(r, c));
    }
  }
}

template <class Pose>
void PoseGraph<Pose>::add_edge_terms(const PoseEdge<Pose>& edge, const PoseVector<Pose>& error,
                                     double weight) {
  constexpr int kDimensions = PoseSpace<Pose>::kDimensions;
  const Pose& from = nodes_[edge.from];
  const Pose& to = nodes_[edge.to];
  const Jacobians<Pose> J = jacobians(edge, from, to);
  const PoseMatrix<Pose> information = weight * edge.information;
  const PoseVector<Pose> weighted_error = information * error;
  const std::size_t i = kDimensions * (edge.from - 1);  // the first node is fixed
  const std::size_t j = kDimensions * (edge.to - 1);
  if (edge.from > 0) {
    add_block(i, i, J.from.transpose() * information * J.from);
    gradient_.template segment<kDimensions>(static_cast<Eigen::Index>(i)) +=
        J.from.transpose() * weighted_error;
  }
  if (edge.to > 0) {
    add_block(j, j, J.to.transpose() * information * J.to);
    gradient_.template segment<kDimensions>(static_cast<Eigen::Index>(j)) +=
        J.to.transpose() * weighted_error;
  }
  if (edge.from > 0 && edge.to > 0) {
    add_block(i, j, J.from.transpose() * information * J.to);
    add_block(j, i, J.to.transpose() * information * J.from);
  }
}

template <class Pose>
std::optional<double> PoseGraph<Pose>::step(double width) {
  constexpr int kDimensions = PoseSpace<Pose>::kDimensions;
  build_normal_equations(width);
  if (structure_changed_) {
    solver_.analyzePattern(hessian_);
    structure_changed_ = false;
  }
  solver_.factorize(hessian_);
  const Eigen::VectorXd change = solver_.solve(-gradient_);
  if (solver_.info() != Eigen::Success || !change.allFinite()) {
    return std::nullopt;
  }
  for (std::size_t k = 1; k < nodes_.size(); ++k) {
    const auto first = static_cast<Eigen::Index>(kDimensions * (k - 1));
    nodes_[k] = moved(nodes_[k], change.template segment<kDimensions>(first));
  }
  return change.cwiseAbs().maxCoeff();
}

template class PoseGraph<SE2>;
template class PoseGraph<SE3>;

}  // namespace nodmap::registration
