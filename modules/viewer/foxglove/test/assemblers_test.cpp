// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/assemblers.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "common/node/messages.hpp"
#include "modules/viewer/foxglove/test/robot_maps.hpp"
#include "modules/viewer/foxglove/test/robot_messages.hpp"

namespace nodmap::foxglove {
namespace assemblers_test {

TEST(GridAssembler, PutsTilesInTheirPlaces) {
  GridAssembler assembler;
  auto tiles = foxglove::test::map_at(0.0, 7);
  tiles[0].cells[0] = 33;      // first cell of the grid
  tiles[1].cells.back() = 44;  // last one
  EXPECT_FALSE(assembler.add(tiles[1]).whole);
  const auto result = assembler.add(tiles[0]);
  ASSERT_TRUE(result.whole);
  ASSERT_EQ(result.whole->cells.size(), 120U * 80U);
  EXPECT_EQ(result.whole->cells.front(), 33);
  EXPECT_EQ(result.whole->cells.back(), 44);
  EXPECT_EQ(result.whole->width, 120);
  // Row 20 from y = -2.0: the wall, in both tiles.
  EXPECT_EQ(result.whole->cells[20 * 120 + 10], 100);
  EXPECT_EQ(result.whole->cells[20 * 120 + 110], 100);
}

TEST(GridAssembler, TilesMissingInARevisionStayAsTheyWere) {
  GridAssembler assembler;
  for (const auto& tile : foxglove::test::map_at(0.0, 1)) {
    (void)assembler.add(tile);
  }
  nodmap::grid_chunk_t changed = foxglove::test::map_at(1.0, 2)[1];
  changed.chunk_index = 0;
  changed.num_chunks = 1;
  changed.cells[0] = 55;
  const auto result = assembler.add(changed);
  ASSERT_TRUE(result.whole);
  EXPECT_EQ(result.whole->cells[60], 55);
  EXPECT_EQ(result.whole->cells[20 * 120 + 10], 100);  // from the previous tile
  EXPECT_EQ(result.whole->stamp, node::stamp_of(changed));
}

TEST(GridAssembler, KnownCellsStayInPlaceWhenTheGridGrows) {
  GridAssembler assembler;
  auto tiles = foxglove::test::map_at(0.0, 1);
  tiles[0].cells[0] = 33;  // at x = -2.0 m, y = -4.0 m
  for (const auto& tile : tiles) {
    (void)assembler.add(tile);
  }
  nodmap::grid_chunk_t grown = tiles[1];
  grown.map_revision = 2;
  grown.chunk_index = 0;
  grown.num_chunks = 1;
  grown.origin_x_m -= 3.0;  // by 30 columns and 10 rows
  grown.origin_y_m -= 1.0;
  grown.grid_width += 50;
  grown.grid_height += 10;
  grown.tile_x += 30;
  grown.tile_y += 10;
  const auto result = assembler.add(grown);
  ASSERT_TRUE(result.whole);
  EXPECT_EQ(result.whole->width, 170);
  EXPECT_EQ(result.whole->cells[10 * 170 + 30], 33);
  EXPECT_EQ(result.whole->cells[0], -1);
  EXPECT_EQ(result.whole->cells[30 * 170 + 40], 100);   // the wall, from a previous tile
  EXPECT_EQ(result.whole->cells[30 * 170 + 140], 100);  // the wall, from a new tile
}

TEST(GridAssembler, ARestartedMapContainsNothingOfTheOldOne) {
  GridAssembler assembler;
  for (const auto& tile : foxglove::test::map_at(0.0, 7)) {
    (void)assembler.add(tile);
  }
  nodmap::grid_chunk_t first = foxglove::test::map_at(1.0, 0)[1];
  first.chunk_index = 0;
  first.num_chunks = 1;
  EXPECT_TRUE(assembler.add(first).refused);  // alone it could be a late one
  const auto result = assembler.add(first);
  ASSERT_TRUE(result.whole);
  EXPECT_EQ(result.whole->cells[20 * 120 + 10], -1);
}

TEST(GridAssembler, ReportsLostTiles) {
  GridAssembler assembler;
  EXPECT_FALSE(assembler.add(foxglove::test::map_at(0.0, 1)[0]).lost);
  const auto next = foxglove::test::map_at(1.0, 2);
  EXPECT_TRUE(assembler.add(next[0]).lost);
  EXPECT_TRUE(assembler.add(next[1]).whole);
}

TEST(GridAssembler, RefusesAContradictoryTile) {
  const nodmap::grid_chunk_t good = foxglove::test::map_at(0.0, 1)[0];
  const auto refused = [&good](auto change) {
    nodmap::grid_chunk_t tile = good;
    change(tile);
    GridAssembler assembler;
    return assembler.add(tile).refused;
  };
  EXPECT_FALSE(refused([](auto&) {}));
  EXPECT_TRUE(refused([](auto& t) { t.tile_x = 61; }));
  EXPECT_TRUE(refused([](auto& t) { t.tile_x = -1; }));
  EXPECT_TRUE(refused([](auto& t) { t.tile_height = 79; }));
  EXPECT_TRUE(refused([](auto& t) { t.chunk_index = 2; }));
  EXPECT_TRUE(refused([](auto& t) { t.cell_size_m = 0.0; }));
  EXPECT_TRUE(refused([](auto& t) { t.origin_x_m = std::numeric_limits<double>::infinity(); }));
  EXPECT_TRUE(refused([](auto& t) { t.grid_width = t.grid_height = 2'000'000'000; }));
}

TEST(GridAssembler, RefusesATileThatItHasAlready) {
  GridAssembler assembler;
  const auto tile = foxglove::test::map_at(0.0, 1)[0];
  EXPECT_FALSE(assembler.add(tile).refused);
  EXPECT_TRUE(assembler.add(tile).refused);
}

TEST(CloudAssembler, JoinsThePartsInOrder) {
  CloudAssembler assembler;
  const auto chunks = foxglove::test::keyframe_at(2.0, 5, 12'000);
  ASSERT_EQ(chunks.size(), 3U);
  EXPECT_FALSE(assembler.add(chunks[0]).whole);
  EXPECT_FALSE(assembler.add(chunks[1]).whole);
  const auto result = assembler.add(chunks[2]);
  ASSERT_TRUE(result.whole);
  ASSERT_EQ(result.whole->xyz_m.size(), 36'000U);
  EXPECT_EQ(result.whole->xyz_m[15'000], chunks[1].points_m[0][0]);
  EXPECT_DOUBLE_EQ(result.whole->T_frame_points.translation().x(), 1.0);
}

TEST(CloudAssembler, LeavesOutInvalidPoints) {
  CloudAssembler assembler;
  auto chunks = foxglove::test::keyframe_at(0.0, 0, 10);
  chunks[0].points_m[3][1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(assembler.add(chunks[0]).whole->xyz_m.size(), 27U);
}

TEST(CloudAssembler, CountsAKeyframeThatLostAPart) {
  CloudAssembler assembler;
  const auto first = foxglove::test::keyframe_at(0.0, 0, 12'000);
  const auto second = foxglove::test::keyframe_at(1.0, 1, 12'000);
  (void)assembler.add(first[0]);
  EXPECT_TRUE(assembler.add(first[2]).lost);
  EXPECT_FALSE(assembler.add(second[0]).lost);
  (void)assembler.add(second[1]);
  EXPECT_TRUE(assembler.add(second[2]).whole);
}

// As many points as one message can have, in each of as many parts as allowed: 11 million.
TEST(CloudAssembler, RefusesMorePointsThanARobotMeasures) {
  CloudAssembler assembler;
  auto chunk = foxglove::test::keyframe_at(0.0, 0, 10)[0];
  chunk.points_m.assign(21'800, {1.0F, 2.0F, 3.0F});
  chunk.num_points = 21'800;
  chunk.num_chunks = CloudAssembler::kMaxChunks;
  std::size_t num_taken = 0;
  for (bool is_refused = false; !is_refused; ++chunk.chunk_index) {
    ASSERT_LT(chunk.chunk_index, chunk.num_chunks);
    is_refused = assembler.add(chunk).refused;
    num_taken += is_refused ? 0 : chunk.points_m.size();
  }
  EXPECT_LE(num_taken, CloudAssembler::kMaxPoints);
  EXPECT_FALSE(assembler.add(chunk).whole);
  const auto next = foxglove::test::keyframe_at(1.0, 1, 12'000);
  (void)assembler.add(next[0]);
  (void)assembler.add(next[1]);
  EXPECT_TRUE(assembler.add(next[2]).whole);
}

TEST(CloudAssembler, RefusesAnInvalidPose) {
  CloudAssembler assembler;
  auto chunk = foxglove::test::keyframe_at(0.0, 0, 10)[0];
  chunk.orientation[0] = 0.0;
  EXPECT_TRUE(assembler.add(chunk).refused);
}

TEST(OctomapAssembler, JoinsThePartsAndReadsThem) {
  OctomapAssembler assembler;
  const auto chunks = test::octomap_at(2.0, 5);
  ASSERT_GT(chunks.size(), 3U);
  Assembled<OctomapView> result;
  for (const auto& chunk : chunks) {
    EXPECT_FALSE(result.whole);
    result = assembler.add(chunk);
  }
  ASSERT_TRUE(result.whole);
  EXPECT_EQ(result.whole->space.cubes.size(), 2U * 60U * 20U);
  EXPECT_EQ(result.whole->stamp, time::from_utime(test::kBeginUs) + 2s);
}

TEST(OctomapAssembler, DropsAMapThatLostAPart) {
  OctomapAssembler assembler;
  const auto first = test::octomap_at(0.0, 0);
  (void)assembler.add(first[0]);
  EXPECT_TRUE(assembler.add(first[2]).lost);
  Assembled<OctomapView> result;
  for (const auto& chunk : test::octomap_at(1.0, 1)) {
    result = assembler.add(chunk);
    EXPECT_FALSE(result.lost);
  }
  EXPECT_TRUE(result.whole);
}

TEST(OctomapAssembler, RefusesBytesThatAreNotAMap) {
  OctomapAssembler assembler;
  auto chunk = test::octomap_at(0.0, 0)[0];
  chunk.num_chunks = 1;  // truncated
  EXPECT_TRUE(assembler.add(chunk).refused);
  chunk.num_chunks = OctomapAssembler::kMaxChunks + 1;
  EXPECT_TRUE(assembler.add(chunk).refused);
  chunk.chunk_index = -1;
  EXPECT_TRUE(assembler.add(chunk).refused);
}

}  // namespace assemblers_test
}  // namespace nodmap::foxglove
