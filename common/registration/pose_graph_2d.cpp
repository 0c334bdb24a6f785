// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/pose_graph_2d.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace nodmap::registration {
namespace {

// Of three degrees of freedom: 99 of 100 true residuals are below.
constexpr double kInlierChiSquared = 11.345;
constexpr double kWidthDecay = 0.4;  // of the kernel, from one stage to the next
constexpr double kConverged = 1e-5;  // m or rad
// Keeps the equations solvable where a node hangs on nothing; 1 km as standard deviation.
constexpr double kDamping = 1e-6;

bool is_finite(const PoseEdge2d& edge) {
  return std::isfinite(edge.T_from_to.x) && std::isfinite(edge.T_from_to.y) &&
         std::isfinite(edge.T_from_to.yaw) && edge.information.allFinite();
}

}  // namespace

Eigen::Vector3d residual(const PoseEdge2d& edge, const geometry::SE2& T_map_from,
                         const geometry::SE2& T_map_to) {
  const geometry::SE2 T_from_to = T_map_from.inverse() * T_map_to;
  return {T_from_to.x - edge.T_from_to.x, T_from_to.y - edge.T_from_to.y,
          geometry::angle_difference(T_from_to.yaw, edge.T_from_to.yaw)};
}

std::size_t PoseGraph2d::add_node(const geometry::SE2& T_map_node) {
  nodes_.push_back(T_map_node);
  structure_changed_ = true;
  return nodes_.size() - 1;
}

void PoseGraph2d::add_edge(const PoseEdge2d& edge) {
  if (edge.from >= nodes_.size() || edge.to >= nodes_.size() || edge.from == edge.to) {
    throw std::invalid_argument("pose graph: an edge needs two nodes of the graph");
  }
  if (!is_finite(edge)) {
    throw std::invalid_argument("pose graph: an edge that is not finite");
  }
  edges_.push_back(edge);
  structure_changed_ = true;
}

double PoseGraph2d::chi_squared(const PoseEdge2d& edge) const {
  const Eigen::Vector3d error = residual(edge, nodes_[edge.from], nodes_[edge.to]);
  return error.dot(edge.information * error);
}

double PoseGraph2d::weight(const PoseEdge2d& edge) const {
  return kernel_weight(edge, 1.0);
}

double PoseGraph2d::kernel_weight(const PoseEdge2d& edge, double width) const {
  if (!edge.may_be_wrong) {
    return 1.0;
  }
  const double scale = width * kInlierChiSquared;
  const double root = scale / (scale + chi_squared(edge));
  return root * root;
}

double PoseGraph2d::widest_kernel() const {
  double largest = 0.0;
  for (const PoseEdge2d& edge : edges_) {
    largest = std::max(largest, edge.may_be_wrong ? chi_squared(edge) : 0.0);
  }
  // Convex for all residuals from twice the largest on.
  return std::max(1.0, 2.0 * largest / kInlierChiSquared);
}

PoseGraph2d::Report PoseGraph2d::optimise(bool graduated, int max_iterations) {
  Report report;
  if (nodes_.size() < 2) {
    report.converged = true;
    return report;
  }
  double width = graduated ? widest_kernel() : 1.0;
  while (report.iterations < max_iterations && !report.converged) {
    const double change = step(width);
    ++report.iterations;
    report.converged = width <= 1.0 && change < kConverged;
    width = std::max(1.0, kWidthDecay * width);
  }
  return report;
}

void PoseGraph2d::build_normal_equations(double width) {
  const auto unknowns = static_cast<Eigen::Index>(3 * (nodes_.size() - 1));
  terms_.clear();
  gradient_ = Eigen::VectorXd::Zero(unknowns);
  for (Eigen::Index k = 0; k < unknowns; ++k) {
    terms_.emplace_back(static_cast<int>(k), static_cast<int>(k), kDamping);
  }
  for (const PoseEdge2d& edge : edges_) {
    add_edge_terms(edge, kernel_weight(edge, width));
  }
  hessian_.resize(unknowns, unknowns);
  hessian_.setFromTriplets(terms_.begin(), terms_.end());
}

void PoseGraph2d::add_edge_terms(const PoseEdge2d& edge, double weight) {
  const geometry::SE2& from = nodes_[edge.from];
  const geometry::SE2& to = nodes_[edge.to];
  const Eigen::Matrix2d R_from_map = from.rotation().transpose();
  const Eigen::Vector2d offset = R_from_map * (to.translation() - from.translation());
  Eigen::Matrix3d J_from = -Eigen::Matrix3d::Identity();
  J_from.topLeftCorner<2, 2>() = -R_from_map;
  J_from(0, 2) = offset.y();
  J_from(1, 2) = -offset.x();
  Eigen::Matrix3d J_to = Eigen::Matrix3d::Identity();
  J_to.topLeftCorner<2, 2>() = R_from_map;

  const Eigen::Matrix3d information = weight * edge.information;
  const Eigen::Vector3d error = information * residual(edge, from, to);
  const auto add_block = [this](std::size_t row, std::size_t column, const Eigen::Matrix3d& block) {
    if (row < column) {
      return;  // the lower half is enough
    }
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        terms_.emplace_back(static_cast<int>(row) + r, static_cast<int>(column) + c, block(r, c));
      }
    }
  };
  const std::size_t i = 3 * (edge.from - 1);  // the first node is no unknown
  const std::size_t j = 3 * (edge.to - 1);
  if (edge.from > 0) {
    add_block(i, i, J_from.transpose() * information * J_from);
    gradient_.segment<3>(static_cast<Eigen::Index>(i)) += J_from.transpose() * error;
  }
  if (edge.to > 0) {
    add_block(j, j, J_to.transpose() * information * J_to);
    gradient_.segment<3>(static_cast<Eigen::Index>(j)) += J_to.transpose() * error;
  }
  if (edge.from > 0 && edge.to > 0) {
    add_block(i, j, J_from.transpose() * information * J_to);
    add_block(j, i, J_to.transpose() * information * J_from);
  }
}

double PoseGraph2d::step(double width) {
  build_normal_equations(width);
  if (structure_changed_) {
    solver_.analyzePattern(hessian_);
    structure_changed_ = false;
  }
  solver_.factorize(hessian_);
  const Eigen::VectorXd change = solver_.solve(-gradient_);
  if (solver_.info() != Eigen::Success || !change.allFinite()) {
    return 0.0;
  }
  for (std::size_t k = 1; k < nodes_.size(); ++k) {
    const auto d = change.segment<3>(static_cast<Eigen::Index>(3 * (k - 1)));
    geometry::SE2& node = nodes_[k];
    node = {node.x + d.x(), node.y + d.y(), geometry::normalize_angle(node.yaw + d.z())};
  }
  return change.cwiseAbs().maxCoeff();
}

}  // namespace nodmap::registration
