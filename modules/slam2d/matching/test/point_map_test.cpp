// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/matching/point_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "modules/slam2d/test/random_points.hpp"

namespace nodmap::slam2d {
namespace point_map_test {

using test::random_points;

constexpr MapParams kParams{.line_radius_m = 0.25};
// Points up to 10 cm from those of the map only refine its lines.
constexpr MapParams kRefineParams{.new_point_distance_m = 0.1, .line_radius_m = 0.25};
const Eigen::Vector2d kNoNormal = Eigen::Vector2d::Zero();

// Expects that all lines lie on the wall y = 2 m, which was seen from smaller y: to this angle,
// and to this distance across it.
void expect_lines_along_wall(const PointMap& map, double angle_deg, double across_m) {
  for (const MapPoint& map_point : map.points()) {
    ASSERT_TRUE(map_point.has_line());
    EXPECT_GT(map_point.line_normal.dot(Eigen::Vector2d(0, -1)),
              std::cos(geometry::deg_to_rad(angle_deg)));
    EXPECT_NEAR(map_point.line_point.y(), 2.0, across_m);
  }
}

TEST(PointMap, NearestAgreesWithBruteForce) {
  PointMap map(kParams);
  const std::vector<OrientedPoint> points = random_points(3000, 1, 5.0);
  for (const OrientedPoint& point : points) {
    map.add(point);
  }
  for (const double reach : {0.03, 0.25, 0.7, 3.0}) {
    for (const OrientedPoint& query : random_points(300, 2, 7.0)) {
      double best = reach;
      const OrientedPoint* expected = nullptr;
      for (const OrientedPoint& point : points) {
        const bool same_side =
            !point.has_normal() || !query.has_normal() || point.normal.dot(query.normal) > 0.5;
        if (same_side && (point.p - query.p).norm() <= best) {
          best = (point.p - query.p).norm();
          expected = &point;
        }
      }
      const MapPoint* found = map.nearest(query, reach);
      ASSERT_EQ(found != nullptr, expected != nullptr);
      if (found != nullptr) {
        ASSERT_EQ(found->point.p, expected->p);
      }
    }
  }
}

TEST(PointMap, ARememberedNeighbourhoodDoesNotChangeTheNearestPoint) {
  PointMap map(kParams);
  for (const OrientedPoint& point : random_points(3000, 7, 5.0)) {
    map.add(point);
  }
  std::mt19937 random(8);
  // The query moves in steps like those of ICP, some of them longer than the free distance around a
  // point, and rotates.
  std::normal_distribution<double> step_m(0.0, 0.02);
  const Eigen::Matrix2d R = geometry::SE2{0.0, 0.0, 0.03}.rotation();
  for (OrientedPoint query : random_points(300, 9, 7.0)) {
    Neighbourhood around;
    PointMap::Block block;
    for (const double reach : {3.0, 0.7, 0.7, 0.25, 0.25, 0.03, 0.03, 0.25}) {
      EXPECT_EQ(map.nearest(query, reach, around, block), map.nearest(query, reach));
      query.p += Eigen::Vector2d(step_m(random), step_m(random));
      query.normal = R * query.normal;
    }
  }
}

// What is remembered around `query` after it moved here from 2 cm away, so that another map point
// may have become the nearest.
Neighbourhood neighbourhood_after_a_step(const PointMap& map, OrientedPoint query) {
  Neighbourhood around;
  PointMap::Block block;
  query.p.x() -= 0.02;
  (void)map.nearest(query, 0.7, around, block);
  query.p.x() += 0.02;
  (void)map.nearest(query, 0.7, around, block);
  return around;
}

TEST(PointMap, WithinTheFreeDistanceThereIsNoOtherPoint) {
  PointMap map(kParams);
  const std::vector<OrientedPoint> points = random_points(1000, 11, 5.0);
  for (const OrientedPoint& point : points) {
    map.add(point);
  }
  for (const OrientedPoint& query : random_points(300, 12, 6.0)) {
    const Neighbourhood around = neighbourhood_after_a_step(map, query);
    for (const OrientedPoint& point : points) {
      const bool may_be_similar =
          !point.has_normal() || !query.has_normal() ||
          point.normal.dot(query.normal) > std::cos(geometry::deg_to_rad(65.0));
      if (may_be_similar && (around.nearest == nullptr || point.p != around.nearest->point.p)) {
        EXPECT_GE((point.p - around.center.p).norm(), around.free_m - 1e-12);  // rounding
      }
    }
  }
}

// This includes places with more points than can be remembered: forty in a square of 20 cm.
TEST(PointMap, WithinTheKnownDistanceAllPointsAreListed) {
  PointMap map(kParams);
  std::vector<OrientedPoint> points = random_points(1000, 13, 5.0);
  const std::vector<OrientedPoint> crowd = random_points(40, 14, 0.1);
  points.insert(points.end(), crowd.begin(), crowd.end());
  for (const OrientedPoint& point : points) {
    map.add(point);
  }
  std::vector<OrientedPoint> queries = random_points(300, 15, 6.0);
  const std::vector<OrientedPoint> in_crowd = random_points(100, 16, 0.2);
  queries.insert(queries.end(), in_crowd.begin(), in_crowd.end());
  for (const OrientedPoint& query : queries) {
    const Neighbourhood around = neighbourhood_after_a_step(map, query);
    for (const OrientedPoint& point : points) {
      const bool may_be_similar =
          !point.has_normal() || !query.has_normal() ||
          point.normal.dot(query.normal) > std::cos(geometry::deg_to_rad(65.0));
      const bool is_known =
          (around.nearest != nullptr && around.nearest->point.p == point.p) ||
          std::any_of(around.others.begin(),
                      around.others.begin() + static_cast<std::ptrdiff_t>(around.num_others),
                      [&](const MapPoint* other) { return other->point.p == point.p; });
      if (may_be_similar && !is_known) {
        EXPECT_GE((point.p - around.center.p).norm(), around.known_m - 1e-12);  // rounding
      }
    }
  }
}

TEST(PointMap, InsertAddsOnlyPointsFarFromAllOthers) {
  const std::vector<OrientedPoint> points = random_points(2000, 17, 1.0);
  PointMap map(kParams);
  map.insert(points);
  std::vector<Eigen::Vector2d> expected;
  for (const OrientedPoint& point : points) {
    if (std::none_of(expected.begin(), expected.end(), [&](const Eigen::Vector2d& other) {
          return (other - point.p).norm() <= kParams.new_point_distance_m;
        })) {
      expected.push_back(point.p);
    }
  }
  ASSERT_EQ(map.points().size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(map.points()[i].point.p, expected[i]);
  }
}

TEST(PointMap, InsertingPointsTogetherOrOneByOneGivesTheSameLines) {
  constexpr MapParams kEveryPoint{.new_point_distance_m = 1e-9, .line_radius_m = 0.25};
  const std::vector<OrientedPoint> points = random_points(500, 10, 1.0);
  PointMap together(kEveryPoint);
  PointMap one_by_one(kEveryPoint);
  together.insert(points);
  for (const OrientedPoint& point : points) {
    one_by_one.add(point);
  }
  ASSERT_EQ(together.points().size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(together.points()[i].line_point, one_by_one.points()[i].line_point);
    EXPECT_EQ(together.points()[i].line_normal, one_by_one.points()[i].line_normal);
  }
}

TEST(PointMap, EmptyMapHasNoNeighbour) {
  EXPECT_EQ(PointMap(kParams).nearest({{0, 0}, kNoNormal}, 10.0), nullptr);
}

TEST(PointMap, PointsOfAWallGiveItsLine) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.01);
  PointMap map(kParams);
  for (int i = 0; i < 100; ++i) {
    map.add({{0.05 * i, 2.0 + noise(random)}, {0, -1}});
  }
  // A line through 11 points with 1 cm of noise over 0.5 m has a standard deviation of 3 mm across
  // and 1.1 degrees. Lines at the ends of the wall have half the points over half the length: 4 mm
  // and 2.7 degrees. The bounds are about three of these standard deviations, or more.
  expect_lines_along_wall(map, 8.0, 0.02);
}

TEST(PointMap, TheTwoSidesOfAThinWallGiveTwoLines) {
  PointMap map(kParams);
  for (int i = 0; i < 40; ++i) {
    map.add({{0.05 * i, 0.00}, {0, -1}});
    map.add({{0.05 * i, 0.08}, {0, 1}});
  }
  for (const MapPoint& map_point : map.points()) {
    ASSERT_TRUE(map_point.has_line());
    EXPECT_NEAR(map_point.line_point.y(), map_point.point.p.y(), 1e-12);
    EXPECT_NEAR(map_point.line_normal.dot(map_point.point.normal), 1.0, 1e-12);
  }
  const MapPoint* upper = map.nearest({{1.0, 0.01}, {0, 1}}, 0.5);
  ASSERT_NE(upper, nullptr);
  EXPECT_EQ(upper->point.p.y(), 0.08);
}

TEST(PointMap, AClusterOfPointsHasNoLine) {
  PointMap map(kParams);
  for (const OrientedPoint& point : random_points(60, 4, 0.15)) {
    map.add({point.p, kNoNormal});
  }
  for (const MapPoint& map_point : map.points()) {
    EXPECT_FALSE(map_point.has_line());
    EXPECT_EQ(map_point.line_point, map_point.point.p);
  }
}

TEST(PointMap, LinesDoNotDependOnThePositionOfTheMap) {
  const Eigen::Vector2d far(576.5, -1234.5);  // the odometry of one recording starts like this
  PointMap here(kParams);
  PointMap there(kParams);
  for (const OrientedPoint& point : random_points(500, 5, 1.0)) {
    here.add(point);
    there.add({point.p + far, point.normal});
  }
  for (std::size_t i = 0; i < here.points().size(); ++i) {
    EXPECT_LT((here.points()[i].line_point + far - there.points()[i].line_point).norm(), 1e-9);
    EXPECT_EQ(here.points()[i].has_line(), there.points()[i].has_line());
  }
}

TEST(PointMap, RepeatedScansOfAWallRefineItsLinesAndAddNoPoint) {
  std::mt19937 random(6);
  std::normal_distribution<double> noise(0.0, 0.01);
  PointMap map(kRefineParams);
  const auto scan_wall = [&](const auto& take) {
    for (int i = 0; i < 100; ++i) {
      take(OrientedPoint{{0.05 * i, 2.0 + noise(random)}, {0, -1}});
    }
  };
  scan_wall([&](const OrientedPoint& point) { map.add(point); });
  for (int i = 0; i < 49; ++i) {
    scan_wall([&](const OrientedPoint& point) { map.insert({&point, 1}); });
  }
  // 50 scans divide the standard deviations of one scan, 3 mm and 1.1 degrees, by 7. At the ends of
  // the wall the lines have half the points over half the length; the bounds are at least four
  // standard deviations of those lines.
  EXPECT_EQ(map.points().size(), 100U);
  expect_lines_along_wall(map, 2.0, 0.0025);
}

TEST(PointMap, TheOtherSideOfAThinWallDoesNotChangeALine) {
  PointMap map(kRefineParams);
  for (int i = 0; i < 40; ++i) {
    map.add({{0.05 * i, 0.00}, {0, -1}});
  }
  for (int i = 0; i < 40; ++i) {
    const OrientedPoint other_side{{0.05 * i, 0.08}, {0, 1}};
    map.insert({&other_side, 1});
  }
  EXPECT_EQ(map.points().size(), 40U);
  for (const MapPoint& map_point : map.points()) {
    EXPECT_EQ(map_point.line_point.y(), 0.0);
  }
}

TEST(PointMap, IgnoresPointsThatAreNotFinite) {
  PointMap map(kParams);
  map.add({{std::numeric_limits<double>::quiet_NaN(), 0.0}, kNoNormal});
  map.add({{0.0, std::numeric_limits<double>::infinity()}, kNoNormal});
  EXPECT_TRUE(map.points().empty());
  map.add({{0.0, 0.0}, {0, 1}});
  const OrientedPoint not_finite{{std::numeric_limits<double>::quiet_NaN(), 0.0}, kNoNormal};
  map.insert({&not_finite, 1});
  EXPECT_EQ(map.points().size(), 1U);
  EXPECT_EQ(map.points()[0].line_point, Eigen::Vector2d(0, 0));
}

}  // namespace point_map_test
}  // namespace nodmap::slam2d
