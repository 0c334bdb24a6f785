// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/grid/keyframe_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace nodmap::slam2d {
namespace keyframe_grid_test {

// A keyframe whose rays are one degree apart and have these lengths.
Keyframe fan(const std::vector<double>& lengths_m) {
  std::vector<Eigen::Vector2f> points;
  for (std::size_t i = 0; i < lengths_m.size(); ++i) {
    const double angle_rad = geometry::deg_to_rad(static_cast<double>(i));
    points.emplace_back(
        (lengths_m[i] * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad))).cast<float>());
  }
  Keyframe keyframe;
  keyframe.points_base = SharedPoints(std::move(points));
  return keyframe;
}

TEST(BelievedLengths, RaysThroughANarrowGapAreCutToTheirNeighboursLength) {
  // A wall, a gap of two rays, a chair leg, and an opening of three rays.
  const std::vector<double> lengths_m{3, 3, 3, 80, 40, 3, 3, 1, 3, 3, 9, 9, 9, 3, 3};
  const std::vector<double> believed_m = believed_lengths(fan(lengths_m));
  ASSERT_EQ(believed_m.size(), lengths_m.size());
  for (std::size_t i = 0; i < lengths_m.size(); ++i) {
    EXPECT_NEAR(believed_m[i], i == 3 || i == 4 ? 3.0 : lengths_m[i], 1e-5) << i;  // float points
  }
}

TEST(BelievedLengths, AWallSeenAtAFlatAngleIsBelieved) {
  std::vector<double> lengths_m;
  for (int degrees = 85; degrees > 3; --degrees) {
    lengths_m.push_back(1.2 / std::sin(geometry::deg_to_rad(degrees)));  // to 17 m
  }
  const std::vector<double> believed_m = believed_lengths(fan(lengths_m));
  for (std::size_t i = 0; i < lengths_m.size(); ++i) {
    EXPECT_NEAR(believed_m[i], lengths_m[i], 1e-5) << i;
  }
}

TEST(BelievedLengths, WithTooFewRaysNoLengthIsBelieved) {
  EXPECT_TRUE(believed_lengths({}).empty());
  EXPECT_EQ(believed_lengths(fan({2.0, 2.0})), std::vector<double>(2, 0.0));
}

// A keyframe that was drawn from a pose can be erased completely from it, including the rays that
// are cut short.
TEST(KeyframeGrid, ErasingUndoesDrawing) {
  const Keyframe keyframe = fan({3, 3, 3, 80, 40, 3, 3, 1, 3, 3});
  const geometry::SE2 T_map_base{1.0, -2.0, 0.7};
  OccupancyGrid grid(0.05);
  draw(keyframe, T_map_base, grid);
  EXPECT_LT(0.05 * std::max(grid.width(), grid.height()), 20.0);  // not 80 m
  erase(keyframe, T_map_base, grid);
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      ASSERT_EQ(grid.occupancy(x, y), OccupancyGrid::kUnknown);
    }
  }
}

// 64 million cells of 5 cm: two corridors of 420 m at a right angle need more.
TEST(KeyframeGrid, RaysBeyondTheLargestGridAreCounted) {
  std::vector<Keyframe> keyframes(3, fan({3, 3, 3, 3, 3}));
  KeyframeGrid map(0.05);
  keyframes[1].T_map_base = {420.0, 0.0, 0.0};
  map.draw_new(std::span(keyframes).first(2));
  EXPECT_EQ(map.rays_beyond(), 0);
  keyframes[2].T_map_base = {0.0, 420.0, 0.0};
  map.draw_new(keyframes);
  EXPECT_EQ(map.rays_beyond(), 5);
}

// The known cells of a grid with their places in map: the same for grids that differ only in size.
std::vector<std::vector<int>> known_cells(const OccupancyGrid& grid) {
  std::vector<std::vector<int>> cells;
  const Eigen::Vector2d first = grid.origin() / grid.cell_size_m();
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      if (grid.occupancy(x, y) != OccupancyGrid::kUnknown) {
        cells.push_back({static_cast<int>(std::lround(first.x())) + x,
                         static_cast<int>(std::lround(first.y())) + y, grid.occupancy(x, y)});
      }
    }
  }
  return cells;
}

std::size_t num_known_in(const OccupancyGrid& grid, const Region& region) {
  const CellRange cells = grid.cells_of(region);
  const auto known = known_cells(grid);
  return static_cast<std::size_t>(std::count_if(known.begin(), known.end(), [&](const auto& cell) {
    return cells.has({cell[0], cell[1]});
  }));
}

// Keyframes with fans that point nearly in the same direction, from poses a little apart.
std::vector<Keyframe> row_of_fans(int count) {
  std::vector<Keyframe> keyframes;
  for (int i = 0; i < count; ++i) {
    keyframes.push_back(fan(std::vector<double>(91, 3.0)));
    keyframes.back().T_map_base = {0.1 * i, -0.05 * i, 0.02 * i};
  }
  return keyframes;
}

const Region kRegion{{0.8, 0.9}, {1.9, 2.2}};

// Both are drawn on, cleared and moved in tiles that they share at first.
TEST(KeyframeGrid, ASnapshotAndItsOriginalDoNotChangeEachOther) {
  std::vector<Keyframe> keyframes = row_of_fans(4);
  KeyframeGrid map(0.05);
  map.draw_new({keyframes.data(), 3});
  KeyframeGrid snapshot = map.snapshot();
  const auto before = known_cells(map.grid());
  EXPECT_EQ(known_cells(snapshot.grid()), before);
  map.draw_new(keyframes);
  ASSERT_TRUE(map.clear(kRegion));
  EXPECT_EQ(known_cells(snapshot.grid()), before);
  const auto after = known_cells(map.grid());
  for (Keyframe& keyframe : keyframes) {
    keyframe.T_map_base = geometry::SE2{0.4, 0.3, 0.1} * keyframe.T_map_base;
  }
  snapshot.redraw_all_moved(keyframes);
  EXPECT_NE(known_cells(snapshot.grid()), before);
  EXPECT_EQ(known_cells(map.grid()), after);
  KeyframeGrid expected(0.05);
  expected.draw_new({keyframes.data(), 3});
  EXPECT_EQ(known_cells(snapshot.grid()), known_cells(expected.grid()));
}

TEST(KeyframeGrid, AClearedRegionIsUnknownAndTheRestStays) {
  const std::vector<Keyframe> keyframes = row_of_fans(3);
  KeyframeGrid map(0.05);
  map.draw_new(keyframes);
  auto expected = known_cells(map.grid());
  ASSERT_GT(num_known_in(map.grid(), kRegion), 100U);
  const CellRange cells = map.grid().cells_of(kRegion);
  std::erase_if(expected, [&](const auto& cell) { return cells.has({cell[0], cell[1]}); });
  ASSERT_TRUE(map.clear(kRegion));
  EXPECT_EQ(known_cells(map.grid()), expected);
}

TEST(KeyframeGrid, LaterKeyframesAreDrawnInAClearedRegion) {
  const std::vector<Keyframe> keyframes = row_of_fans(4);
  KeyframeGrid map(0.05);
  map.draw_new({keyframes.data(), 3});
  ASSERT_TRUE(map.clear(kRegion));
  map.draw_new(keyframes);
  KeyframeGrid last(0.05);  // only the last of them
  last.draw_new({keyframes.data() + 3, 1});
  EXPECT_EQ(num_known_in(map.grid(), kRegion), num_known_in(last.grid(), kRegion));
  EXPECT_GT(num_known_in(map.grid(), kRegion), 100U);
}

// Loop closures move rays into the cleared region and out of it. The keyframes are not drawn there,
// and when they are erased no count is left.
TEST(KeyframeGrid, MovedKeyframesAreNotDrawnInAClearedRegion) {
  std::vector<Keyframe> keyframes = row_of_fans(3);
  KeyframeGrid map(0.05);
  map.draw_new(keyframes);
  ASSERT_TRUE(map.clear(kRegion));
  for (Keyframe& keyframe : keyframes) {
    keyframe.T_map_base = geometry::SE2{0.4, 0.3, 0.1} * keyframe.T_map_base;
  }
  map.redraw_all_moved(keyframes);
  EXPECT_EQ(num_known_in(map.grid(), kRegion), 0U);
  map.drop({.first = 0, .keyframes = keyframes});
  EXPECT_TRUE(known_cells(map.grid()).empty());
  EXPECT_TRUE(map.cleared().empty()) << "no keyframe is left that it hides";
}

TEST(KeyframeGrid, AfterADropAClearedRegionStillHidesEarlierKeyframes) {
  std::vector<Keyframe> keyframes = row_of_fans(4);
  KeyframeGrid map(0.05);
  map.draw_new({keyframes.data(), 3});
  ASSERT_TRUE(map.clear(kRegion));
  map.draw_new(keyframes);
  map.drop({.first = 1, .keyframes = {keyframes[1]}});
  keyframes.erase(keyframes.begin() + 1);
  ASSERT_EQ(map.cleared().size(), 1U);
  EXPECT_EQ(map.cleared().front().num_keyframes, 2U);
  // The same grid results if it is drawn anew with the cleared region as it would be saved.
  KeyframeGrid restored(0.05);
  restored.restore_cleared(map.cleared());
  restored.draw_new(keyframes);
  EXPECT_EQ(known_cells(map.grid()), known_cells(restored.grid()));
}

TEST(KeyframeGrid, AClearedRegionReplacesThoseInsideIt) {
  std::vector<Keyframe> keyframes = row_of_fans(3);
  KeyframeGrid map(0.05);
  map.draw_new({keyframes.data(), 2});
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(map.clear({{0.9, 1.0}, {1.5, 2.0}}));
  }
  map.draw_new(keyframes);
  ASSERT_TRUE(map.clear(kRegion));
  ASSERT_EQ(map.cleared().size(), 1U);
  EXPECT_EQ(map.cleared().front().num_keyframes, 3U);
  keyframes[0].T_map_base = geometry::SE2{0.4, 0.3, 0.1} * keyframes[0].T_map_base;
  map.redraw_all_moved(keyframes);
  EXPECT_EQ(num_known_in(map.grid(), kRegion), 0U);
}

TEST(KeyframeGrid, ClearsNoMoreThanTheGreatestNumberOfRegions) {
  const std::vector<Keyframe> keyframes = row_of_fans(1);
  KeyframeGrid map(0.05);
  map.draw_new(keyframes);
  for (std::size_t i = 0; i < KeyframeGrid::kMaxCleared; ++i) {
    const double y = 10.0 + static_cast<double>(i);
    ASSERT_TRUE(map.clear({{0.0, y}, {1.0, y + 1.0}}));
  }
  const auto before = known_cells(map.grid());
  EXPECT_FALSE(map.clear(kRegion));
  EXPECT_EQ(known_cells(map.grid()), before);
  EXPECT_TRUE(map.clear({{0.0, 10.0}, {1.0, 12.0}})) << "two regions become one";
  EXPECT_TRUE(map.clear(kRegion));
}

TEST(KeyframeGrid, ClearingARegionOutsideTheMapChangesNothing) {
  const std::vector<Keyframe> keyframes = row_of_fans(1);
  KeyframeGrid map(0.05);
  map.draw_new(keyframes);
  const auto before = known_cells(map.grid());
  ASSERT_TRUE(map.clear({{1e300, -1.0}, {1.5e300, 1.0}}));
  ASSERT_TRUE(map.clear({{-50.0, -50.0}, {-40.0, -40.0}}));
  EXPECT_EQ(known_cells(map.grid()), before);
}

}  // namespace keyframe_grid_test
}  // namespace nodmap::slam2d
