// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/place_search.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "modules/slam6d/test/hall.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

VoxelMap map_of(const Room& room, const std::vector<SE3>& poses) {
  VoxelMap map{VoxelMapParams{}};
  for (std::size_t k = 0; k < poses.size(); ++k) {
    map.add_sweep(sweep_at(room, poses[k], static_cast<unsigned>(k)), poses[k], k);
  }
  return map;
}

SE3 pose(double x_m, double y_m, double yaw_deg) {
  SE3 T = SE3::Identity();
  T.translation() = Eigen::Vector3d(x_m, y_m, 0.0);
  T.linear() = geometry::rotation_of({0.0, 0.0, geometry::deg_to_rad(yaw_deg)});
  return T;
}

// A square hall looks the same from four sides.
TEST(PlaceSearch, APlaceThatIsThereTwiceIsRefused) {
  Room square = Room::corridor();
  square.walls = {{{0, 0, 1}, 0.0},  {{0, 0, 1}, 2.5}, {{1, 0, 0}, 8.0},
                  {{-1, 0, 0}, 8.0}, {{0, 1, 0}, 8.0}, {{0, -1, 0}, 8.0}};
  std::vector<SE3> keyframes;
  for (int k = 0; k < 9; ++k) {
    keyframes.push_back(pose(k - 4.0, 0.0, 0.0));
  }
  const VoxelMap map = map_of(square, keyframes);
  const StartsResult found =
      PlaceSearch({}, keyframes, map).find(sweep_at(square, pose(2.0, 0.0, 0.0), 99), map);
  EXPECT_FALSE(found.best);
  EXPECT_TRUE(found.is_ambiguous);
}

TEST(PlaceSearch, AnotherBuildingIsNotFound) {
  const std::vector<SE3> keyframes = circle(57);
  const VoxelMap map = map_of(slanting_hall(), keyframes);
  const StartsResult found =
      PlaceSearch({}, keyframes, map).find(sweep_at(Room::hall(), pose(0.0, 0.0, 0.0), 99), map);
  EXPECT_TRUE(!found.best || found.best->lowest_inlier_ratio() < 0.5);
}

TEST(PlaceSearch, WithoutWallsNothingIsFound) {
  const Room floor{{{{0, 0, 1}, 0.0}, {{0, 0, 1}, 2.5}}};
  const std::vector<SE3> keyframes{pose(0.0, 0.0, 0.0)};
  const VoxelMap map = map_of(floor, keyframes);
  EXPECT_FALSE(PlaceSearch({}, keyframes, map).find(sweep_at(floor, keyframes[0], 99), map).best);
  EXPECT_FALSE(PlaceSearch({}, keyframes, map).find(VoxelMap{VoxelMapParams{}}, map).best);
}

}  // namespace
}  // namespace nodmap::slam6d
