// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/localise/seen_space.hpp"

#include <gtest/gtest.h>

#include "modules/slam6d/test/hall.hpp"

namespace nodmap::slam6d {
namespace seen_space_test {

using Content = SeenSpace::Content;

// The left wall of the hall is at y = 1.1 m.
TEST(SeenSpace, DistinguishesFreeOccupiedAndUnknownSpace) {
  const TestMap map(Room::hall(), along_hall());
  const SeenSpace seen({}, map.keyframes);
  EXPECT_EQ(seen.at({1.0F, 0.0F, 1.0F}), Content::kFree);
  EXPECT_EQ(seen.at({1.0F, 1.1F, 1.0F}), Content::kOccupied);
  EXPECT_EQ(seen.at({1.0F, 0.95F, 1.0F}), Content::kOccupied) << "in the voxel beside";
  EXPECT_EQ(seen.at({1.0F, 2.0F, 1.0F}), Content::kUnknown) << "behind it";
  EXPECT_EQ(seen.at({1e9F, 0.0F, 0.0F}), Content::kUnknown) << "outside of all grids";
}

TEST(SeenSpace, ASweepOfTheSamePlaceContradictsNothing) {
  const TestMap map(Room::hall(), along_hall());
  const geometry::SE3 T_map_base = pose(0.4, 0.2, 40.0);
  const Evidence evidence =
      SeenSpace({}, map.keyframes).compare(sweep_at(Room::hall(), T_map_base, 99), T_map_base);
  EXPECT_GT(evidence.seen, 500.0);
  EXPECT_EQ(evidence.contradicted, 0.0);
}

// The visible fronts of the cabinets are 1.2 m x 1.8 m and 1 m x 1.8 m, and their visible sides 1.1
// m x 1.8 m: together 594 voxels of 10 cm. Those within 20 cm of wall and floor are no
// contradictions.
TEST(SeenSpace, ObjectsInFreeSpaceAreContradictions) {
  const TestMap map(Room::hall(), along_hall());
  const geometry::SE3 T_map_base = pose(0.0, 0.0, 0.0);
  const Evidence evidence =
      SeenSpace({}, map.keyframes).compare(sweep_at(look_alike_hall(), T_map_base, 99), T_map_base);
  EXPECT_GT(evidence.contradicted, 100.0);
  EXPECT_LT(evidence.contradicted, 594.0);
  EXPECT_GT(evidence.contradiction_ratio(), 0.06);
}

TEST(SeenSpace, PointsInUnknownSpaceDoNotCount) {
  const TestMap map(Room::hall(), along_hall());
  const Evidence evidence =
      SeenSpace({}, map.keyframes)
          .compare(sweep_at(look_alike_hall(), pose(0.0, 0.0, 0.0), 99), pose(100.0, 0.0, 0.0));
  EXPECT_EQ(evidence.seen, 0.0);
  EXPECT_EQ(evidence.contradicted, 0.0);
  EXPECT_EQ(evidence.contradiction_ratio(), 0.0);
}

// The robot is in a hall without the cabinets of the map. Half of their visible 594 voxels must
// show it; beams 2 degrees apart leave gaps in single voxels.
TEST(SeenSpace, SurfacesOfTheMapThatBeamsPassThroughContradict) {
  const TestMap map(look_alike_hall(), along_hall());
  const SeenSpace seen_by_map({}, map.keyframes);
  SeenSpace seen({});
  EXPECT_EQ(seen.compare_map(map.voxels, seen_by_map, {0.0, 0.0, 0.0}).contradiction_ratio(), 0.0);
  for (const double x_m : {-1.5, 0.0, 1.5}) {
    const geometry::SE3 T_map_base = pose(x_m, 0.0, 20.0);
    seen.add(cloud_at(Room::hall(), T_map_base, 99), T_map_base);
  }
  const Evidence missing = seen.compare_map(map.voxels, seen_by_map, {0.0, 0.0, 0.0});
  EXPECT_GT(missing.contradicted, 100.0);
  EXPECT_GT(missing.seen, 500.0);
}

TEST(SeenSpace, AtTheSamePlaceNoSurfaceOfTheMapIsMissing) {
  const TestMap map(look_alike_hall(), along_hall());
  SeenSpace seen({});
  const geometry::SE3 T_map_base = pose(0.4, 0.2, 40.0);
  seen.add(cloud_at(look_alike_hall(), T_map_base, 99), T_map_base);
  const Evidence missing =
      seen.compare_map(map.voxels, SeenSpace({}, map.keyframes), T_map_base.translation());
  EXPECT_GT(missing.seen, 500.0);
  EXPECT_EQ(missing.contradicted, 0.0);
}

// What one sweep has seen is not missing, though the beams of another went through.
TEST(SeenSpace, SweepsAreTakenTogether) {
  const TestMap map(look_alike_hall(), along_hall());
  const SeenSpace seen_by_map({}, map.keyframes);
  SeenSpace seen({});
  seen.add(cloud_at(Room::hall(), pose(0.0, 0.0, 0.0), 98), pose(0.0, 0.0, 0.0));
  EXPECT_GT(seen.compare_map(map.voxels, seen_by_map, {0.0, 0.0, 0.0}).contradicted, 0.0);
  for (const geometry::SE3& T_map_base : along_hall()) {
    seen.add(cloud_at(look_alike_hall(), T_map_base, 99), T_map_base);
  }
  EXPECT_EQ(seen.compare_map(map.voxels, seen_by_map, {0.0, 0.0, 0.0}).contradicted, 0.0);
}

// The cabinets were carried away while the map was made.
TEST(SeenSpace, WhatMovedWhileTheMapWasMadeIsNotMissing) {
  const TestMap before(look_alike_hall(), along_hall());
  const TestMap after(Room::hall(), along_hall());
  SeenSpace seen_by_map({}, before.keyframes);
  SeenSpace seen({});
  for (const Keyframe& keyframe : after.keyframes) {
    seen_by_map.add(*keyframe.cloud, keyframe.T_map_base);
    seen.add(*keyframe.cloud, keyframe.T_map_base);
  }
  const Evidence missing = seen.compare_map(before.voxels, seen_by_map, {0.0, 0.0, 0.0});
  EXPECT_GT(missing.seen, 500.0);
  EXPECT_EQ(missing.contradicted, 0.0);
}

}  // namespace seen_space_test
}  // namespace nodmap::slam6d
