// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/pose_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "modules/slam2d/scan_surface.hpp"
#include "modules/slam2d/test/drawn_world.hpp"

namespace nodmap::slam2d {
namespace {

using geometry::SE2;

TEST(PoseSearch, FindsTheWayBackFromALargeTurn) {
  test::Scanner scanner(0.01);
  ScanSurface surface;
  PointMap map(0.25);
  for (const SurfacePoint& point : surface.points(scanner.scan(test::room(), {}))) {
    map.add(point);
  }
  const auto points = surface.points(scanner.scan(test::room(), {}));
  const PoseSearch search{Slam2dParams{}};
  const SE2 guess{0.4, -0.3, geometry::deg_to_rad(70.0)};
  const auto candidates = search.candidates(map, points, guess);
  ASSERT_FALSE(candidates.empty());
  // The grid's step is 0.25 m and 4 degrees: ICP does the rest.
  EXPECT_TRUE(std::any_of(candidates.begin(), candidates.end(), [](const SE2& pose) {
    return std::hypot(pose.x, pose.y) < 0.3 && std::abs(pose.yaw) < geometry::deg_to_rad(8.0);
  }));
}

TEST(PoseSearch, CandidatesAreDistinctAndWithinReach) {
  const Slam2dParams params;
  const auto candidates = PoseSearch(params).candidates(PointMap(0.25), {}, {1.0, 2.0, 3.0});
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    EXPECT_LE(std::abs(candidates[i].x - 1.0), params.search_distance_m);
    EXPECT_LE(std::abs(candidates[i].y - 2.0), params.search_distance_m);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_TRUE(
          std::hypot(candidates[i].x - candidates[j].x, candidates[i].y - candidates[j].y) > 0.2 ||
          std::abs(geometry::angle_difference(candidates[i].yaw, candidates[j].yaw)) > 0.06);
    }
  }
  // With nothing to go by, odometry comes first.
  ASSERT_FALSE(candidates.empty());
  EXPECT_EQ(candidates.front().x, 1.0);
}

TEST(PoseSearch, WithoutASearchAreaOnlyTheGuessIsLeft) {
  Slam2dParams params;
  params.search_distance_m = 0.0;
  params.search_rotation_rad = 0.0;
  EXPECT_EQ(PoseSearch(params).candidates(PointMap(0.25), {}, {}).size(), 1U);
}

}  // namespace
}  // namespace nodmap::slam2d
