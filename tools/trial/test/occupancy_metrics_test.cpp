// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/occupancy_metrics.hpp"

#include <gtest/gtest.h>

namespace nodmap::trial {
namespace occupancy_metrics_test {

// Not the default of 6D SLAM, so that a size written elsewhere shows.
constexpr double kVoxelM = 0.1;
const slam6d::TraceParams kParams{.resolution_m = kVoxelM, .max_range_m = 2.0};

// A wall across the x axis with its surface at 1 m.
sim::World wall_world() {
  sim::World world;
  world.objects.push_back({sim::Box{{1.05, 0.0, 0.5}, {0.1, 4.0, 3.0}, 0.0}});
  return world;
}

// Voxels at this x, side by side along y, at a height of 0.5 m.
formats::OccupiedSpace row_at(double x_m, int count) {
  formats::OccupiedSpace map;
  map.voxel_m = kVoxelM;
  for (int i = 0; i < count; ++i) {
    const auto voxel = ObservedVoxels(kParams).voxel_at({x_m, (i + 0.5) * kVoxelM, 0.525});
    formats::OccupiedSpace::Cube cube;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cube.key.at(axis) =
          static_cast<std::uint16_t>(voxel.at(axis) + formats::OccupiedSpace::kOriginKey);
    }
    map.cubes.push_back(cube);
  }
  return map;
}

// Beams from the mirror straight ahead, `count` side by side.
ObservedVoxels observed_row(int count, float range_m = 0.999F) {
  scan::Scan scan;
  scan.range_max_m = 30.0;
  scan.ranges_m = {range_m};
  ObservedVoxels observed(kParams);
  for (int i = 0; i < count; ++i) {
    geometry::SE3 T_map_base = geometry::SE3::Identity();
    T_map_base.translation() << 0.0, (i + 0.5) * kVoxelM, 0.525;
    observed.add(scan, T_map_base, T_map_base);
  }
  return observed;
}

OccupancyMetrics compare(const formats::OccupiedSpace& map, const ObservedVoxels& observed) {
  return occupancy_metrics(map, observed, geometry::SE3::Identity(), wall_world());
}

TEST(OccupancyMetrics, AMapOfTheWallIsRight) {
  const OccupancyMetrics metrics = compare(row_at(0.99, 10), observed_row(10));
  EXPECT_EQ(metrics.num_occupied, 10U);
  EXPECT_EQ(metrics.num_observed, 10U);
  EXPECT_EQ(metrics.precision, 1.0);
  EXPECT_EQ(metrics.recall, 1.0);
}

TEST(OccupancyMetrics, VoxelsInTheAirCostPrecisionAndMissingOnesRecall) {
  formats::OccupiedSpace map = row_at(0.99, 4);
  const formats::OccupiedSpace air = row_at(0.6, 4);
  map.cubes.insert(map.cubes.end(), air.cubes.begin(), air.cubes.end());
  const OccupancyMetrics metrics = compare(map, observed_row(10));
  EXPECT_EQ(metrics.precision, 0.5);
  EXPECT_EQ(metrics.recall, 0.5);  // four, and the neighbour of the last
}

TEST(OccupancyMetrics, ACubeOfALevelIsAllOfItsVoxels) {
  formats::OccupiedSpace map = row_at(0.99, 1);
  map.cubes[0].level = 1;
  EXPECT_EQ(compare(map, observed_row(1)).num_occupied, 8U);
}

TEST(OccupancyMetrics, NothingIsComparedWithoutAMap) {
  EXPECT_EQ(compare({}, observed_row(1)).precision, 0.0);
}

TEST(OccupancyMetrics, BeamsBeyondTheRangeOfTheMapAreNotExpectedInIt) {
  EXPECT_EQ(observed_row(3, 1.99F).voxels().size(), 3U);
  EXPECT_TRUE(observed_row(3, 2.01F).voxels().empty());
}

}  // namespace occupancy_metrics_test
}  // namespace nodmap::trial
