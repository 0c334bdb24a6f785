// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/localise/relocaliser.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "common/geometry/pose_tolerance.hpp"
#include "modules/slam6d/test/hall.hpp"

namespace nodmap::slam6d {
namespace relocaliser_test {

using geometry::SE3;

StartsResult find(const TestMap& map, const std::vector<SE3>& poses, const VoxelMap& sweep) {
  const Relocaliser search({}, {}, poses, map.voxels);
  return search.find(sweep, map.voxels, [](const SE3& /*T_map_base*/) { return true; });
}

// Walls are up to 20 m away, so that half a step of the searched headings moves them by 0.9 m. With
// 5 mm of range noise a registration is exact to 1 cm and 0.1 degrees.
TEST(Relocaliser, APlaceInAHallWithDistantWallsIsFound) {
  const std::vector<SE3> keyframes = circle(57);
  const TestMap map(slanting_hall(), keyframes);
  for (const SE3& T_map_base : {pose(9.13, 0.4, 97.4), pose(-9.2, -0.3, -42.6)}) {
    const StartsResult found = find(map, keyframes, sweep_at(slanting_hall(), T_map_base, 99));
    ASSERT_TRUE(found.best);
    EXPECT_TRUE(
        geometry::is_within(T_map_base, found.best->T_map_base, {0.01, geometry::deg_to_rad(0.1)}));
  }
}

// Walls of the map are up to 450 m apart, too far for cells of 20 cm.
TEST(Relocaliser, APlaceInALargeBuildingIsFound) {
  const std::vector<SE3> keyframes = along_hall();
  TestMap map(Room::hall(), keyframes);
  const SE3 T_map_far = pose(320.0, 320.0, 0.0);
  map.voxels.add_sweep(sweep_at(Room::hall(), SE3::Identity(), 98), T_map_far);
  const SE3 T_map_base = pose(0.2, -0.1, 3.0);
  const StartsResult found = find(map, keyframes, sweep_at(Room::hall(), T_map_base, 99));
  ASSERT_TRUE(found.best);
  EXPECT_TRUE(
      geometry::is_within(T_map_base, found.best->T_map_base, {0.01, geometry::deg_to_rad(0.2)}));
}

// A square hall looks the same at four headings.
TEST(Relocaliser, APlaceThatIsThereTwiceIsAmbiguous) {
  Room square = Room::corridor();
  square.walls = {{{0, 0, 1}, 0.0},  {{0, 0, 1}, 2.5}, {{1, 0, 0}, 8.0},
                  {{-1, 0, 0}, 8.0}, {{0, 1, 0}, 8.0}, {{0, -1, 0}, 8.0}};
  std::vector<SE3> keyframes;
  for (int k = 0; k < 9; ++k) {
    keyframes.push_back(pose(k - 4.0, 0.0, 0.0));
  }
  const StartsResult found =
      find(TestMap(square, keyframes), keyframes, sweep_at(square, pose(2.0, 0.0, 0.0), 99));
  EXPECT_FALSE(found.best);
  EXPECT_TRUE(found.is_ambiguous);
}

TEST(Relocaliser, AnotherBuildingIsNotFound) {
  const std::vector<SE3> keyframes = circle(57);
  const StartsResult found = find(TestMap(slanting_hall(), keyframes), keyframes,
                                  sweep_at(Room::hall(), pose(0.0, 0.0, 0.0), 99));
  EXPECT_TRUE(!found.best || found.best->lowest_inlier_ratio() < 0.5);
}

TEST(Relocaliser, OnlyPossiblePlacesCount) {
  const std::vector<SE3> keyframes = along_hall();
  const TestMap map(Room::hall(), keyframes);
  const SE3 T_map_base = pose(0.2, -0.1, 3.0);
  const VoxelMap sweep = sweep_at(Room::hall(), T_map_base, 99);
  const StartsResult found = find(map, keyframes, sweep);
  ASSERT_TRUE(found.best);
  EXPECT_TRUE(
      geometry::is_within(T_map_base, found.best->T_map_base, {0.01, geometry::deg_to_rad(0.2)}));
  const Relocaliser search({}, {}, keyframes, map.voxels);
  const StartsResult elsewhere = search.find(sweep, map.voxels, [&](const SE3& T_map_tried) {
    return !geometry::is_within(T_map_base, T_map_tried, {0.1, geometry::deg_to_rad(2.0)});
  });
  EXPECT_TRUE(!elsewhere.best || elsewhere.best->lowest_inlier_ratio() < 0.5);
}

TEST(Relocaliser, WithoutWallsNothingIsFound) {
  const Room floor{{{{0, 0, 1}, 0.0}, {{0, 0, 1}, 2.5}}};
  const std::vector<SE3> keyframes{pose(0.0, 0.0, 0.0)};
  const TestMap map(floor, keyframes);
  EXPECT_FALSE(find(map, keyframes, sweep_at(floor, keyframes[0], 99)).best);
  EXPECT_FALSE(find(map, keyframes, VoxelMap{VoxelMapParams{}}).best);
}

}  // namespace relocaliser_test
}  // namespace nodmap::slam6d
