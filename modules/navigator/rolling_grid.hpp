// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace nodmap::navigator {

/// A square grid of 2^`log2_size` cells a side that moves with the robot. A cell is a fixed square
/// of odom and keeps its place in memory while it is inside the grid; one that enters is reset.
template <class Cell>
class RollingGrid {
 public:
  RollingGrid(double cell_size_m, int log2_size)
      : cell_size_m_(cell_size_m),
        size_(1 << log2_size),
        log2_size_(log2_size),
        cells_(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_)) {}

  [[nodiscard]] double cell_size_m() const { return cell_size_m_; }
  [[nodiscard]] int size() const { return size_; }
  /// First row and column that are inside; the last ones are size() - 1 farther.
  [[nodiscard]] const Eigen::Vector2i& first() const { return first_; }

  [[nodiscard]] Eigen::Vector2i index_of(const Eigen::Vector2d& p_odom) const {
    return {line_of(p_odom.x()), line_of(p_odom.y())};
  }
  [[nodiscard]] Eigen::Vector2d center_of(const Eigen::Vector2i& index) const {
    return cell_size_m_ * (index.cast<double>() + Eigen::Vector2d(0.5, 0.5));
  }
  [[nodiscard]] bool contains(const Eigen::Vector2i& index) const {
    const Eigen::Vector2i offset = index - first_;
    return offset.x() >= 0 && offset.y() >= 0 && offset.x() < size_ && offset.y() < size_;
  }

  /// Only for cells inside.
  [[nodiscard]] Cell& at(const Eigen::Vector2i& index) { return cells_[slot_of(index)]; }
  [[nodiscard]] const Cell& at(const Eigen::Vector2i& index) const {
    return cells_[slot_of(index)];
  }

  /// The cell at a place; null outside.
  [[nodiscard]] Cell* find(const Eigen::Vector2d& p_odom) {
    const Eigen::Vector2i index = index_of(p_odom);
    return contains(index) ? &at(index) : nullptr;
  }
  [[nodiscard]] const Cell* find(const Eigen::Vector2d& p_odom) const {
    const Eigen::Vector2i index = index_of(p_odom);
    return contains(index) ? &at(index) : nullptr;
  }

  /// The cell at a column and row, counted from the first ones.
  [[nodiscard]] Cell& at_offset(int column, int row) {
    return at(Eigen::Vector2i(first_.x() + column, first_.y() + row));
  }

  /// Makes every cell Cell{}.
  void clear() { cells_.assign(cells_.size(), Cell{}); }

  /// The same as center_on() for a grid in which every cell is Cell{}.
  void center_empty_on(const Eigen::Vector2d& p_odom) {
    first_ = index_of(p_odom) - Eigen::Vector2i::Constant(size_ / 2);
  }

  /// Moves the grid so that `p_odom` is in its middle; cells that enter are Cell{}.
  void center_on(const Eigen::Vector2d& p_odom) {
    const Eigen::Vector2i first = index_of(p_odom) - Eigen::Vector2i::Constant(size_ / 2);
    const Eigen::Vector2i shift = first - first_;
    const bool is_far = shift.cwiseAbs().maxCoeff() >= size_;
    const Eigen::Vector2i old_first = first_;
    first_ = first;
    if (is_far) {
      clear();
      return;
    }
    for (int axis = 0; axis < 2; ++axis) {
      const int from = shift[axis] > 0 ? old_first[axis] + size_ : first_[axis];
      for (int line = from; line < from + std::abs(shift[axis]); ++line) {
        clear_line(axis, line);
      }
    }
  }

 private:
  /// The row or column, limited far beyond any odometry, so that it always fits an int.
  [[nodiscard]] int line_of(double odom_m) const {
    constexpr double kFarthest = 1 << 28;
    return static_cast<int>(std::clamp(std::floor(odom_m / cell_size_m_), -kFarthest, kFarthest));
  }
  [[nodiscard]] std::size_t slot_of(const Eigen::Vector2i& index) const {
    const int mask = size_ - 1;
    const int slot = ((index.y() & mask) << log2_size_) | (index.x() & mask);
    return static_cast<std::size_t>(slot);
  }
  void clear_line(int axis, int line) {
    for (int along = 0; along < size_; ++along) {
      cells_[slot_of(axis == 0 ? Eigen::Vector2i(line, along) : Eigen::Vector2i(along, line))] = {};
    }
  }

  double cell_size_m_;
  int size_;
  int log2_size_;
  Eigen::Vector2i first_ = Eigen::Vector2i::Zero();
  std::vector<Cell> cells_;
};

}  // namespace nodmap::navigator
