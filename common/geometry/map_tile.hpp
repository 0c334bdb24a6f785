// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

namespace nodmap::geometry {

/// A rectangle of the 2D map, as in MAP_2D. Cells are numbered from the origin of map: cell (0, 0)
/// extends from 0 to one cell size in x and y.
struct MapTile {
  double cell_size_m = 0.05;
  Eigen::Vector2i first = Eigen::Vector2i::Zero();
  int width = 0;
  int height = 0;
  std::span<const std::int8_t>
      cells;  ///< row by row, x fastest; 0 free .. 100 occupied, -1 unknown

  /// From this percentage on a cell is occupied; the same as in the images of the map. It is low
  /// because many rays only graze the cell of a wall.
  static constexpr std::int8_t kOccupiedPercent = 25;
};

}  // namespace nodmap::geometry
