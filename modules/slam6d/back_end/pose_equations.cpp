// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/pose_equations.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>

namespace nodmap::slam6d {

std::optional<Eigen::VectorXd> PoseEquations::solve() const {
  std::vector<Eigen::Triplet<double>> lower_triangle;
  lower_triangle.reserve(36 * blocks_.size());
  for (const auto& [key, block] : blocks_) {
    const std::size_t row = key / num_poses_;
    const std::size_t column = key % num_poses_;
    for (int r = 0; row > 0 && r < 6; ++r) {
      for (int c = row == column ? r : 0; c < 6; ++c) {
        lower_triangle.emplace_back(static_cast<int>(6 * (column - 1)) + c,
                                    static_cast<int>(6 * (row - 1)) + r, block(r, c));
      }
    }
  }
  const auto size = static_cast<Eigen::Index>(6 * (num_poses_ - 1));
  Eigen::SparseMatrix<double> H(size, size);
  H.setFromTriplets(lower_triangle.begin(), lower_triangle.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(H);
  if (solver.info() != Eigen::Success) {
    return std::nullopt;
  }
  Eigen::VectorXd motions = Eigen::VectorXd::Zero(size + 6);
  motions.tail(size) = solver.solve(g_.tail(size));
  return motions.allFinite() ? std::optional(motions) : std::nullopt;
}

}  // namespace nodmap::slam6d
