// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/model/voxel_map.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace nodmap::slam6d {
namespace voxel_map_test {

using Eigen::Vector3f;
using geometry::SE3;

// The points of a wall of 4 m x 4 m at x = `x_m`, on a grid with this spacing; the noise is along
// x.
std::vector<Vector3f> wall(float x_m, float spacing_m, float noise_m, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0.0F, 1.0F);
  std::vector<Vector3f> points;
  for (float y = -2.0F; y < 2.0F; y += spacing_m) {
    for (float z = -2.0F; z < 2.0F; z += spacing_m) {
      points.emplace_back(x_m + noise_m * noise(random), y, z);
    }
  }
  return points;
}

// Dense points have planes at the finest level, and sparse ones at the first level at which they
// have neighbours. Each place is used only once.
TEST(VoxelMap, EachPlaceIsUsedAtTheFinestLevelThatHasAPlane) {
  const VoxelMap dense = VoxelMap::from_points(wall(2.0F, 0.02F, 0.0F, 1), Vector3f::Zero(), {});
  const auto fine = dense.select(0);
  EXPECT_GT(fine.first_of_level[1], 1'000U);
  EXPECT_EQ(fine.first_of_level[1], fine.points.size());
  const auto coarse = dense.select(2);
  EXPECT_EQ(coarse.first_of_level[2], 0U);
  EXPECT_GT(coarse.points.size(), 80U);

  const VoxelMap sparse = VoxelMap::from_points(wall(2.0F, 0.3F, 0.0F, 1), Vector3f::Zero(), {});
  const auto selection = sparse.select(0);
  EXPECT_EQ(selection.first_of_level[1], 0U);
  EXPECT_GT(selection.points.size(), 50U);
  for (const OrientedPoint& point : selection.points) {
    EXPECT_LT((point.normal + Vector3f::UnitX()).norm(), 1e-3F);  // towards the sensor
  }
}

// A wall is measured from a distance of 10 m and, 2 cm off, from 1 m. The near measurement has (1 +
// 10^2/3^2) / (1 + 1/3^2) = 10.9 times the weight of the far one, whichever comes first.
TEST(VoxelMap, NearMeasurementsOutweighFarOnes) {
  const VoxelMapParams params{.trusted_range_m = 3.0};
  const VoxelMap far =
      VoxelMap::from_points(wall(10.02F, 0.05F, 0.0F, 1), Vector3f::Zero(), params);
  const VoxelMap near = VoxelMap::from_points(wall(1.0F, 0.05F, 0.0F, 1), Vector3f::Zero(), params);
  SE3 T_map_near = SE3::Identity();
  T_map_near.translation().x() = 9.04;
  for (const bool is_far_first : {true, false}) {
    VoxelMap map(params);
    map.add_sweep(is_far_first ? far : near, is_far_first ? SE3::Identity() : T_map_near);
    map.add_sweep(is_far_first ? near : far, is_far_first ? T_map_near : SE3::Identity());
    const auto place = map.level(0).nearest({10.03F, 0.05F, 0.05F}, 0.1F);
    ASSERT_NE(place, VoxelGrid::kNone);
    // The mean of 10.04 m and 10.02 m with weights of 10.9 and 1; the ratio is a little smaller,
    // because the beams are slanted.
    EXPECT_NEAR(map.level(0).voxels()[place].mean.x(), 10.0383F, 5e-4F);
  }
}

// Memory is bounded by the mapped volume, not by the number of sweeps.
TEST(VoxelMap, MemoryDoesNotGrowWithSweepsOfTheSamePlace) {
  const VoxelMapParams params;
  VoxelMap map(params);
  std::size_t bytes = 0;
  for (unsigned k = 0; k < 30; ++k) {
    map.add_sweep(VoxelMap::from_points(wall(2.05F, 0.03F, 0.01F, k), Vector3f::Zero(), params),
                  SE3::Identity());
    bytes = k == 0 ? map.memory_bytes() : bytes;
  }
  EXPECT_LE(map.memory_bytes(), bytes);
}

// There are two walls from two keyframes. Each wall moves with its keyframe, and only those of
// chosen keyframes are added.
TEST(VoxelMap, VoxelsMoveWithTheirKeyframes) {
  const VoxelMapParams params;
  VoxelMap map(params);
  for (std::size_t k = 0; k < 2; ++k) {
    const float x_m = k == 0 ? 2.05F : 4.05F;
    map.add_sweep(VoxelMap::from_points(wall(x_m, 0.05F, 0.0F, 1), Vector3f::Zero(), params),
                  SE3::Identity(), k);
  }
  std::vector<SE3> motions(2, SE3::Identity());
  motions[1].translation().x() = 0.5;
  const auto walls = [&](const std::vector<bool>& is_chosen) {
    VoxelMap moved(params);
    moved.add_keyframes(map, motions, is_chosen);
    std::vector<float> found;
    for (const float x_m : {2.05F, 4.05F, 4.55F}) {
      const auto place = moved.level(0).nearest({x_m, 0.05F, 0.05F}, 0.05F);
      if (place != VoxelGrid::kNone) {
        EXPECT_NEAR(moved.level(0).voxels()[place].mean.x(), x_m, 1e-5F);
        EXPECT_NEAR(moved.level(0).voxels()[place].normal.x(), -1.0F, 1e-5F);
        found.push_back(x_m);
      }
    }
    return found;
  };
  EXPECT_EQ(walls({true, true}), (std::vector<float>{2.05F, 4.55F}));
  EXPECT_EQ(walls({true, false}), (std::vector<float>{2.05F}));
  EXPECT_EQ(walls({false, true}), (std::vector<float>{4.55F}));
}

// The second of three keyframes is dropped: its wall moves with the third.
TEST(VoxelMap, VoxelsOfADroppedKeyframeGoToTheOneThatReplacesIt) {
  const VoxelMapParams params;
  VoxelMap map(params);
  for (std::size_t k = 0; k < 3; ++k) {
    map.add_sweep(VoxelMap::from_points(wall(2.05F + 2.0F * static_cast<float>(k), 0.05F, 0.0F, 1),
                                        Vector3f::Zero(), params),
                  SE3::Identity(), k);
  }
  map.drop_keyframe({.index = 1, .by = 2});
  std::vector<SE3> motions(2, SE3::Identity());
  motions[1].translation().x() = 0.5;
  VoxelMap moved(params);
  moved.add_keyframes(map, motions, {true, true});
  for (const float x_m : {2.05F, 4.55F, 6.55F}) {
    EXPECT_NE(moved.level(0).nearest({x_m, 0.05F, 0.05F}, 0.05F), VoxelGrid::kNone) << x_m;
  }
}

TEST(VoxelMap, AnEmptySweepAddsNothing) {
  const VoxelMap empty = VoxelMap::from_points({}, Vector3f::Zero(), {});
  EXPECT_TRUE(empty.select(0).points.empty());
  VoxelMap map{VoxelMapParams{}};
  map.add_sweep(empty, SE3::Identity());
  EXPECT_TRUE(map.level(0).voxels().empty());
}

}  // namespace voxel_map_test
}  // namespace nodmap::slam6d
