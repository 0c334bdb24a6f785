// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace nodmap::navigator {

/// The rectangle of cells that a plan covers; frame map. The cells of a plan far ahead are coarser.
struct PlanWindow {
  static constexpr double kCellM = 0.05;  ///< of the ground and of the usual plan

  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< outer corner of cell (0, 0)
  int width = 0;
  int height = 0;
  double cell_m = kCellM;  ///< a multiple of kCellM

  [[nodiscard]] std::size_t num_cells() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  [[nodiscard]] bool contains(int column, int row) const {
    return column >= 0 && row >= 0 && column < width && row < height;
  }
  /// The index of a cell inside; cells are stored row by row.
  [[nodiscard]] std::size_t index_of(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(column);
  }
  [[nodiscard]] Eigen::Vector2d center_of(int column, int row) const {
    return origin + cell_m * Eigen::Vector2d(column + 0.5, row + 0.5);
  }
  /// The column and row of a place, which may be outside.
  [[nodiscard]] Eigen::Vector2i cell_of(const Eigen::Vector2d& p_map) const {
    return ((p_map - origin) / cell_m).array().floor().cast<int>();
  }
};

}  // namespace nodmap::navigator
