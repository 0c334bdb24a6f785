// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/matching/pose_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

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

// Short walls 30 to 40 m away, far apart. The best start pose brings all of them within the reach
// of a match; a rotation by 2 degrees, half of a fixed step of 4, would move them by a metre or
// more.
TEST(PoseSearch, FindsARotationInTheOpen) {
  std::vector<OrientedPoint> points;
  for (int wall = 0; wall < 16; ++wall) {
    const SE2 T_base_wall{0.0, 0.0, geometry::deg_to_rad(15.0 * wall + 4.0 * (wall * wall % 5))};
    for (double along_m = -0.5; along_m <= 0.5; along_m += 0.1) {
      points.push_back({T_base_wall * Eigen::Vector2d(30.0 + 5.0 * (wall % 3), along_m),
                        T_base_wall.rotation() * Eigen::Vector2d(-1.0, 0.0)});
    }
  }
  PointMap map{MapParams{}};
  map.insert(points);
  const SE2 guess{0.0, 0.0, geometry::deg_to_rad(6.0)};
  const auto candidates = PoseSearch(SearchParams{}).candidates(map, points, {&guess, 1});
  ASSERT_FALSE(candidates.empty());
  for (const OrientedPoint& point : points) {
    EXPECT_LT((candidates.front() * point.p - point.p).norm(),
              MatcherParams{}.max_correspondence_distance_m);
  }
}

}  // namespace pose_search_test
}  // namespace nodmap::slam2d
