// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/cloud_tracer.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstddef>
#include <cstdint>

#include "modules/slam6d/test/hall.hpp"

namespace nodmap::slam6d {
namespace cloud_tracer_test {

using geometry::SE3;

CloudVoxels traced(const SweepCloud& cloud, bool walk_once) {
  CloudTracer tracer({.resolution_m = 0.07, .walk_once = walk_once});
  CloudVoxels voxels;
  tracer.trace(cloud, pose(0.3, 0.2, 10.0), voxels);
  return voxels;
}

struct Counts {
  std::size_t all = 0;
  std::size_t of_both = 0;
  std::size_t differ_in_occupied = 0;
};

// Compares what is free in `some` with what is free in `all`; both have the same cubes.
Counts compared(const CloudVoxels& all, const CloudVoxels& some) {
  Counts counts;
  EXPECT_EQ(all.cubes().size(), some.cubes().size());
  const auto count = [](std::uint64_t bits) {
    return static_cast<std::size_t>(std::popcount(bits));
  };
  for (const auto& cube : all.cubes()) {
    for (const auto& other : some.cubes()) {
      for (std::size_t word = 0; cube->code == other->code && word < CloudVoxels::kWords; ++word) {
        EXPECT_EQ(other->free[word] & ~cube->free[word], 0U);
        counts.all += count(cube->free[word]);
        counts.of_both += count(cube->free[word] & other->free[word]);
        counts.differ_in_occupied += count(cube->occupied[word] ^ other->occupied[word]);
      }
    }
  }
  return counts;
}

// A hall seen with beams 0.5 degrees apart around the robot: near walls and the floor have several
// points in each voxel.
SweepCloud dense_cloud() {
  SweepCloud cloud;
  const Room room = Room::hall();
  const Eigen::Vector3d p_mirror(0.0, 0.0, 0.4);
  for (int pitch = -40; pitch <= 40; ++pitch) {
    for (int yaw = 0; yaw < 720; ++yaw) {
      const Eigen::Vector3d direction =
          geometry::rotation_of({0.0, 0.0, geometry::deg_to_rad(0.5 * yaw)}) *
          geometry::rotation_of({0.0, geometry::deg_to_rad(pitch), 0.0}) * Eigen::Vector3d::UnitX();
      const double range_m = room.range_m(p_mirror, direction);
      if (range_m < 30.0) {
        cloud.points.emplace_back((p_mirror + range_m * direction).cast<float>());
      }
    }
  }
  cloud.lines.push_back({.p_base_mirror = p_mirror.cast<float>(), .end = cloud.points.size()});
  return cloud;
}

// The oracle: all beams are walked. What is left out lies at the rim of what others pass through.
TEST(CloudTracer, WalkedOnceBeamsMarkNearlyTheSameVoxels) {
  const SweepCloud cloud = dense_cloud();
  const Counts counts = compared(traced(cloud, false), traced(cloud, true));
  EXPECT_EQ(counts.differ_in_occupied, 0U);
  EXPECT_GT(counts.all, 100'000U);
  EXPECT_GT(static_cast<double>(counts.of_both), 0.97 * static_cast<double>(counts.all));
  EXPECT_LT(counts.of_both, counts.all) << "all beams were walked";
}

TEST(CloudTracer, WithoutPointsNothingIsMarked) {
  EXPECT_TRUE(traced({}, true).cubes().empty());
}

TEST(WalkedBeams, ABeamBetweenTheSameTwoVoxelsIsRemembered) {
  WalkedBeams walked;
  walked.clear();
  EXPECT_TRUE(walked.remember(1, 0));
  EXPECT_FALSE(walked.remember(1, 0));
  EXPECT_TRUE(walked.remember(2, 0));
  EXPECT_TRUE(walked.remember(2, 1));
  EXPECT_FALSE(walked.remember(2, 1));
  walked.clear();
  EXPECT_TRUE(walked.remember(2, 1));
}

}  // namespace cloud_tracer_test
}  // namespace nodmap::slam6d
