// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/pose_equations.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <utility>
#include <vector>

namespace nodmap::slam6d {

// Whole poses are ordered instead of their six unknowns each: that takes hardly any time, and no
// further copies of H, which is the largest thing in memory at the end of a long drive.
PoseEquations::Order PoseEquations::elimination_order() const {
  std::vector<Eigen::Triplet<double>> joined;
  joined.reserve(blocks_.size());
  for (const auto& [key, block] : blocks_) {
    if (const std::size_t row = key / num_poses_; row > 0) {
      joined.emplace_back(static_cast<int>(row - 1), static_cast<int>(key % num_poses_ - 1), 1.0);
    }
  }
  Eigen::SparseMatrix<double> graph(num_free(), num_free());
  graph.setFromTriplets(joined.begin(), joined.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(graph.selfadjointView<Eigen::Upper>(), order);
  return order.inverse().eval().indices().cast<Eigen::Index>();
}

std::vector<PoseEquations::PlacedBlock> PoseEquations::placed_blocks(const Order& order) const {
  std::vector<PlacedBlock> placed;
  placed.reserve(blocks_.size());
  for (const auto& [key, block] : blocks_) {
    if (key >= num_poses_) {
      const Eigen::Index row = order(static_cast<Eigen::Index>(key / num_poses_ - 1));
      const Eigen::Index column = order(static_cast<Eigen::Index>(key % num_poses_ - 1));
      placed.push_back({std::max(row, column), std::min(row, column), &block, row > column});
    }
  }
  std::ranges::sort(placed, {}, [](const PlacedBlock& at) { return std::pair(at.column, at.row); });
  return placed;
}

Eigen::SparseMatrix<double> PoseEquations::upper_triangle(const Order& order) const {
  const std::vector<PlacedBlock> placed = placed_blocks(order);
  Eigen::SparseMatrix<double> H(6 * num_free(), 6 * num_free());
  H.reserve(static_cast<Eigen::Index>(36 * placed.size()));
  auto begin = placed.begin();
  for (Eigen::Index column = 0; column < H.cols(); ++column) {
    const Eigen::Index pose = column / 6;
    H.startVec(column);
    auto end = begin;
    for (; end != placed.end() && end->column == pose; ++end) {
      for (Eigen::Index r = 0; r < 6 && 6 * end->row + r <= column; ++r) {
        H.insertBack(6 * end->row + r, column) = end->at(r, column % 6);
      }
    }
    if (column % 6 == 5) {
      begin = end;
    }
  }
  H.finalize();
  return H;
}

std::optional<Eigen::VectorXd> PoseEquations::solve() const {
  const Order order = elimination_order();
  const Eigen::SparseMatrix<double> H = upper_triangle(order);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Upper,
                              Eigen::NaturalOrdering<int>>
      solver(H);
  if (solver.info() != Eigen::Success) {
    return std::nullopt;
  }
  Eigen::VectorXd g(6 * num_free());
  for (Eigen::Index i = 0; i < num_free(); ++i) {
    g.segment<6>(6 * order(i)) = g_.segment<6>(6 * (i + 1));
  }
  const Eigen::VectorXd x = solver.solve(g);
  Eigen::VectorXd motions = Eigen::VectorXd::Zero(g_.size());
  for (Eigen::Index i = 0; i < num_free(); ++i) {
    motions.segment<6>(6 * (i + 1)) = x.segment<6>(6 * order(i));
  }
  return motions.allFinite() ? std::optional(motions) : std::nullopt;
}

}  // namespace nodmap::slam6d
