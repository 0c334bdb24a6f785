// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/map_tile.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace nodmap::node {
namespace map_tile_test {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();

// The second tile of a grid of 4 x 2 cells, whose corner is at (-1, 0.5) m.
nodmap::grid_chunk_t sample_tile() {
  nodmap::grid_chunk_t message{};
  message.cell_size_m = 0.1;
  message.origin_x_m = -1.0;
  message.origin_y_m = 0.5;
  message.grid_width = 4;
  message.grid_height = 2;
  message.tile_x = 2;
  message.tile_width = 2;
  message.tile_height = 2;
  message.cells = {0, 100, -1, 30};
  message.num_cells = 4;
  return message;
}

TEST(MapTile, CellsAreNumberedFromTheOriginOfMap) {
  const nodmap::grid_chunk_t message = sample_tile();
  const auto tile = read_map_tile(message);
  ASSERT_TRUE(tile);
  EXPECT_EQ(tile->first, Eigen::Vector2i(-8, 5));
  EXPECT_EQ(tile->width, 2);
  EXPECT_EQ(tile->height, 2);
  EXPECT_EQ(tile->cells.data(), message.cells.data());
}

TEST(MapTile, ImplausibleTilesAreRefused) {
  const auto is_refused = [](const auto& change) {
    nodmap::grid_chunk_t message = sample_tile();
    change(message);
    return !read_map_tile(message);
  };
  EXPECT_TRUE(is_refused([](auto& m) { m.cell_size_m = 0.0; }));
  EXPECT_TRUE(is_refused([](auto& m) { m.cell_size_m = kInf; }));
  EXPECT_TRUE(
      is_refused([](auto& m) { m.cell_size_m = std::numeric_limits<double>::quiet_NaN(); }));
  EXPECT_TRUE(is_refused([](auto& m) { m.origin_x_m = -kInf; }));
  EXPECT_TRUE(is_refused([](auto& m) { m.origin_y_m = 1e9; }));
  EXPECT_TRUE(is_refused([](auto& m) { m.tile_x = -1; }));
  EXPECT_TRUE(is_refused([](auto& m) { m.grid_height = m.tile_y = kMost; }));
  EXPECT_TRUE(is_refused([](auto& m) { m.tile_x = 3; })) << "it extends beyond the grid";
  EXPECT_TRUE(is_refused([](auto& m) { m.tile_y = 1; }));
  EXPECT_TRUE(is_refused([](auto& m) { m.grid_width = kMost; }));
  EXPECT_TRUE(is_refused([](auto& m) { m.cells.clear(); }));
  EXPECT_TRUE(is_refused([](auto& m) { m.tile_width = 0; }));
  EXPECT_TRUE(is_refused([](auto& m) { m.tile_width = m.tile_height = -2; }));
  // As a number of 64 bits the product is right; as one of 32 bits it would be 0.
  EXPECT_TRUE(is_refused([](auto& m) { m.tile_width = m.tile_height = 1 << 16; }));
  EXPECT_TRUE(is_refused([](auto& m) { m = {}; }));
}

}  // namespace map_tile_test
}  // namespace nodmap::node
