// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/map_tile.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace nodmap::node {
namespace {

// Tiles farther away than this are refused, so that cell indices stay exact.
constexpr double kFarthestTileM = 10'000.0;
// Grids with more cells to a side are refused, so that cell indices do not overflow.
constexpr int kMaxCells = 1 << 20;

}  // namespace

std::optional<geometry::MapTile> read_map_tile(const nodmap::grid_chunk_t& message) {
  const Eigen::Vector2d origin_m(message.origin_x_m, message.origin_y_m);
  const bool has_place = message.cell_size_m > 0.001 && std::isfinite(message.cell_size_m) &&
                         origin_m.allFinite() && origin_m.cwiseAbs().maxCoeff() <= kFarthestTileM &&
                         message.tile_x >= 0 && message.tile_y >= 0 &&
                         message.tile_x <= std::min(message.grid_width, kMaxCells) &&
                         message.tile_y <= std::min(message.grid_height, kMaxCells);
  const bool has_cells = message.tile_width > 0 && message.tile_width <= kMaxCells &&
                         message.tile_height > 0 && message.tile_height <= kMaxCells &&
                         message.cells.size() == static_cast<std::size_t>(message.tile_width) *
                                                     static_cast<std::size_t>(message.tile_height);
  if (!has_place || !has_cells) {
    return std::nullopt;
  }
  const Eigen::Vector2i origin = (origin_m / message.cell_size_m).array().round().cast<int>();
  return geometry::MapTile{message.cell_size_m,
                           origin + Eigen::Vector2i(message.tile_x, message.tile_y),
                           message.tile_width, message.tile_height, message.cells};
}

}  // namespace nodmap::node
