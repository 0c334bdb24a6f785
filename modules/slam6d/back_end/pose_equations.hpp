// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <optional>
#include <unordered_map>
#include <vector>

#include "modules/slam6d/registration/matrix6d.hpp"

namespace nodmap::slam6d {

/// Sparse normal equations H x = g of the small motions (position in m, rotation vector in rad,
/// axes of map) of many poses, six unknowns each. The first pose is fixed.
class PoseEquations {
 public:
  /// `num_poses`: at least 1.
  explicit PoseEquations(std::size_t num_poses)
      : num_poses_(num_poses),
        g_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(6 * num_poses))) {}

  /// A block of H, for row <= column.
  [[nodiscard]] Matrix6d& block(std::size_t row, std::size_t column) {
    return blocks_.try_emplace(row * num_poses_ + column, Matrix6d::Zero()).first->second;
  }
  /// A segment of g.
  [[nodiscard]] auto gradient(std::size_t pose) {
    return g_.segment<6>(static_cast<Eigen::Index>(6 * pose));
  }

  /// Solves for the motions, zero for the first pose; empty if there is no solution.
  [[nodiscard]] std::optional<Eigen::VectorXd> solve() const;

 private:
  /// The place of each pose in the order of elimination by which few blocks fill in.
  using Order = Eigen::Matrix<Eigen::Index, Eigen::Dynamic, 1>;
  /// A block of H, or its transpose, where it is in the upper triangle.
  struct PlacedBlock {
    Eigen::Index column;
    Eigen::Index row;
    const Matrix6d* block;
    bool is_transposed;

    [[nodiscard]] double at(Eigen::Index r, Eigen::Index c) const {
      return is_transposed ? (*block)(c, r) : (*block)(r, c);
    }
  };

  /// The poses that are not fixed. Of these alone are the order, the blocks and the matrix below.
  [[nodiscard]] Eigen::Index num_free() const { return static_cast<Eigen::Index>(num_poses_ - 1); }
  [[nodiscard]] Order elimination_order() const;
  /// The blocks in this order, by column and row.
  [[nodiscard]] std::vector<PlacedBlock> placed_blocks(const Order& order) const;
  [[nodiscard]] Eigen::SparseMatrix<double> upper_triangle(const Order& order) const;

  std::size_t num_poses_;
  std::unordered_map<std::size_t, Matrix6d> blocks_;
  Eigen::VectorXd g_;
};

}  // namespace nodmap::slam6d
