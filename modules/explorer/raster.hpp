// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace nodmap::explorer {

/// Column and row of a cell, numbered from the origin of map; may be negative.
using Cell = Eigen::Vector2i;

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

}  // namespace nodmap::explorer
