// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/map_tile.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace nodmap::node {
namespace {

// Tiles farther away than this are refused, so that cell indices stay exact.
constexpr double kFarthestTileM = 10'000.0;
// Grids with more cells to a side are refused, so that cell indices do not overflow.
constexpr int kMaxCells = 1 << 20;

// Whether a tile has cells along one side, all within the grid.
bool is_within(std::int32_t first, std::int32_t num_cells, std::int32_t grid_cells) {
  return grid_cells <= kMaxCells && first >= 0 && num_cells > 0 && num_cells <= grid_cells &&
         first <= grid_cells - num_cells;
}

}  // namespace

std::optional<geometry::MapTile> read_map_tile(const nodmap::grid_chunk_t& message) {
  const Eigen::Vector2d origin_m(message.origin_x_m, message.origin_y_m);
  const bool has_place = message.cell_size_m > 0.001 && std::isfinite(message.cell_size_m) &&
                         origin_m.allFinite() && origin_m.cwiseAbs().maxCoeff() <= kFarthestTileM &&
                         is_within(message.tile_x, message.tile_width, message.grid_width) &&
                         is_within(message.tile_y, message.tile_height, message.grid_height);
  const bool has_cells = message.cells.size() == static_cast<std::size_t>(message.tile_width) *
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
