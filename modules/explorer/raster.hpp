// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace nodmap::explorer {

/// Column and row of a cell, numbered from the origin of map; may be negative.
using Cell = Eigen::Vector2i;

/// The quotient, rounded towards minus infinity; `divisor` > 0.
[[nodiscard]] constexpr int floor_divide(int dividend, int divisor) {
  return dividend >= 0 ? dividend / divisor : -((divisor - 1 - dividend) / divisor);
}

/// A rectangle of cells with one value each.
template <class Value>
class Raster {
 public:
  [[nodiscard]] bool is_empty() const { return values_.empty(); }
  [[nodiscard]] const Cell& first() const { return first_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] bool contains(const Cell& cell) const {
    const Cell offset = cell - first_;
    return offset.x() >= 0 && offset.y() >= 0 && offset.x() < width_ && offset.y() < height_;
  }
  /// The index of a contained cell: row by row, x fastest.
  [[nodiscard]] std::size_t index_of(const Cell& cell) const {
    const Cell offset = cell - first_;
    return static_cast<std::size_t>(offset.y()) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(offset.x());
  }
  [[nodiscard]] Cell cell_at(std::size_t index) const {
    const auto width = static_cast<std::size_t>(width_);
    return first_ + Cell(static_cast<int>(index % width), static_cast<int>(index / width));
  }
  [[nodiscard]] Value& at(const Cell& cell) { return values_[index_of(cell)]; }
  [[nodiscard]] const Value& at(const Cell& cell) const { return values_[index_of(cell)]; }
  [[nodiscard]] Value& operator[](std::size_t index) { return values_[index]; }
  [[nodiscard]] const Value& operator[](std::size_t index) const { return values_[index]; }

  /// Covers these cells, all with the same value.
  void reset(const Cell& first, int width, int height, const Value& value) {
    first_ = first;
    width_ = width;
    height_ = height;
    values_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value);
  }

  /// Extends to these cells, which include all present ones; new ones get `value`.
  void grow(const Cell& first, int width, int height, const Value& value) {
    Raster grown;
    grown.reset(first, width, height, value);
    for (int row = 0; row < height_; ++row) {
      const auto from =
          values_.begin() + static_cast<std::ptrdiff_t>(row) * static_cast<std::ptrdiff_t>(width_);
      const std::size_t to = grown.index_of(first_ + Cell(0, row));
      std::copy(from, from + width_, grown.values_.begin() + static_cast<std::ptrdiff_t>(to));
    }
    *this = std::move(grown);
  }

 private:
  Cell first_ = Cell::Zero();
  int width_ = 0;
  int height_ = 0;
  std::vector<Value> values_;
};

/// Marks on the cells of a raster, by their indices. Removing all of them takes no time.
class Marks {
 public:
  /// Removes all marks; the raster has `size` cells.
  void begin(std::size_t size) {
    if (marked_in_.size() != size) {
      marked_in_.assign(size, 0);
      round_ = 0;
    }
    ++round_;
  }
  /// Returns whether the cell was not marked yet.
  bool mark(std::size_t index) { return std::exchange(marked_in_[index], round_) != round_; }
  [[nodiscard]] bool is_marked(std::size_t index) const { return marked_in_[index] == round_; }

 private:
  std::vector<std::uint32_t> marked_in_;  // for each cell, the round in which it was marked last
  std::uint32_t round_ = 0;
};

}  // namespace nodmap::explorer
