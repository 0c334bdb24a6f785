// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "modules/navigator/local_map/local_cell.hpp"
#include "modules/navigator/local_map/obstacle_memory.hpp"

namespace nodmap::navigator {

/// The state of all cells in a square of the local map at one moment, one byte each. Made for
/// callers that read all of them: asked one by one, each cell would check four others for edges of
/// holes.
class LocalView {
 public:
  /// The state of a cell, as bits; 0 where nothing is known, and outside the square.
  static constexpr unsigned kFloor = 1;
  static constexpr unsigned kBlocked = 2;    ///< by an obstacle or a hole, or the edge of a hole
  static constexpr unsigned kForgotten = 4;  ///< an obstacle that no longer counts
  static constexpr unsigned kCleared = 8;    ///< see LocalCell::is_cleared()

  /// The cells up to `reach` to each side of `middle`.
  LocalView(const LocalGrid& grid, const ObstacleMemory& obstacles, const Eigen::Vector2i& middle,
            int reach);

  [[nodiscard]] unsigned at(const Eigen::Vector2i& index) const {
    const Eigen::Vector2i offset = index - first_;
    return is_inside(offset) ? bits_[index_of(offset)] : 0U;
  }
  /// The same for a place converted by in_cells().
  [[nodiscard]] unsigned at(const Eigen::Vector2d& cells) const {
    // Negative values are outside; a cast would round them up into the first cell.
    return cells.x() >= 0.0 && cells.y() >= 0.0 ? at_offset(cells) : 0U;
  }
  /// A place in cells from the outer corner of the square.
  [[nodiscard]] Eigen::Vector2d in_cells(const Eigen::Vector2d& p_odom) const {
    return cells_per_m_ * p_odom - first_.cast<double>();
  }
  [[nodiscard]] double cells_per_m() const { return cells_per_m_; }

 private:
  [[nodiscard]] unsigned at_offset(const Eigen::Vector2d& cells) const {
    const Eigen::Vector2i offset = cells.cast<int>();
    return is_inside(offset) ? bits_[index_of(offset)] : 0U;
  }
  [[nodiscard]] bool is_inside(const Eigen::Vector2i& offset) const {
    return offset.x() >= 0 && offset.y() >= 0 && offset.x() < size_ && offset.y() < size_;
  }
  [[nodiscard]] std::size_t index_of(const Eigen::Vector2i& offset) const {
    return static_cast<std::size_t>(offset.y()) * static_cast<std::size_t>(size_) +
           static_cast<std::size_t>(offset.x());
  }
  void block_around_hole(const LocalGrid& grid, const Eigen::Vector2i& index);

  Eigen::Vector2i first_;
  int size_;
  double cells_per_m_;
  std::vector<std::uint8_t> bits_;
};

}  // namespace nodmap::navigator
