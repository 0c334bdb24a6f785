// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/pose_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "modules/slam2d/test/drawn_world.hpp"

namespace nodmap::slam2d {
namespace pose_search_test {

using geometry::SE2;

TEST(PoseSearch, FindsThePoseAfterALargeRotation) {
  test::Scanner scanner(0.01);
  OrientedPointExtractor extractor;
  PointMap map{MapParams{}};
  for (const OrientedPoint& point : extractor.extract(scanner.scan(test::room(), {}), {})) {
    map.add(point);
  }
  const auto points = extractor.extract(scanner.scan(test::room(), {}), {});
  const PoseSearch search{SearchParams{}};
  const SE2 guess{0.4, -0.3, geometry::deg_to_rad(70.0)};
  const auto candidates = search.candidates(map, points, {&guess, 1});
  ASSERT_FALSE(candidates.empty());
  // Candidates are 0.25 m and 4 degrees apart; ICP then finds the exact pose.
  EXPECT_TRUE(std::any_of(candidates.begin(), candidates.end(), [](const SE2& pose) {
    return std::hypot(pose.x, pose.y) < 0.3 && std::abs(pose.yaw) < geometry::deg_to_rad(8.0);
  }));
}

TEST(PoseSearch, CandidatesAreDistinctAndWithinTheSearchArea) {
  const SearchParams params;
  const SE2 guess{1.0, 2.0, 3.0};
  const auto candidates = PoseSearch(params).candidates(PointMap(MapParams{}), {}, {&guess, 1});
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    EXPECT_LE(std::abs(candidates[i].x - 1.0), params.distance_m);
    EXPECT_LE(std::abs(candidates[i].y - 2.0), params.distance_m);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_TRUE(
          std::hypot(candidates[i].x - candidates[j].x, candidates[i].y - candidates[j].y) > 0.2 ||
          std::abs(geometry::angle_difference(candidates[i].yaw, candidates[j].yaw)) > 0.06);
    }
  }
  // If all poses have the same score, the guess comes first.
  ASSERT_FALSE(candidates.empty());
  EXPECT_EQ(candidates.front().x, 1.0);
}

TEST(PoseSearch, WithoutASearchAreaTheGuessIsTheOnlyCandidate) {
  SearchParams params;
  params.distance_m = 0.0;
  params.rotation_rad = 0.0;
  const SE2 guess;
  EXPECT_EQ(PoseSearch(params).candidates(PointMap(MapParams{}), {}, {&guess, 1}).size(), 1U);
}

}  // namespace pose_search_test
}  // namespace nodmap::slam2d
