// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/point_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace nodmap::slam2d {
namespace {

constexpr double kRadius = 0.25;
const Eigen::Vector2d kNoNormal = Eigen::Vector2d::Zero();

std::vector<SurfacePoint> random_points(int count, unsigned seed, double half_size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-half_size, half_size);
  std::uniform_real_distribution<double> angle(-geometry::kPi, geometry::kPi);
  std::vector<SurfacePoint> points;
  for (int i = 0; i < count; ++i) {
    const double a = angle(random);
    const bool alone = i % 5 == 0;
    points.push_back({{coordinate(random), coordinate(random)},
                      alone ? kNoNormal : Eigen::Vector2d(std::cos(a), std::sin(a))});
  }
  return points;
}

/// The wall is at y = 2 m and looks down.
void expect_lines_along_wall(const PointMap& map, double angle_deg, double across_m) {
  for (const PointMap::Landmark& landmark : map.landmarks()) {
    ASSERT_TRUE(landmark.is_on_line());
    EXPECT_GT(landmark.normal.dot(Eigen::Vector2d(0, -1)),
              std::cos(geometry::deg_to_rad(angle_deg)));
    EXPECT_NEAR(landmark.centre.y(), 2.0, across_m);
  }
}

TEST(PointMap, NearestAgreesWithBruteForce) {
  PointMap map(kRadius);
  const std::vector<SurfacePoint> points = random_points(3000, 1, 5.0);
  for (const SurfacePoint& point : points) {
    map.add(point);
  }
  for (const double reach : {0.03, 0.25, 0.7, 3.0}) {
    for (const SurfacePoint& query : random_points(300, 2, 7.0)) {
      double best = reach;
      const SurfacePoint* expected = nullptr;
      for (const SurfacePoint& point : points) {
        const bool same_side =
            !point.has_normal() || !query.has_normal() || point.normal.dot(query.normal) > 0.5;
        if (same_side && (point.p - query.p).norm() <= best) {
          best = (point.p - query.p).norm();
          expected = &point;
        }
      }
      const PointMap::Landmark* found = map.nearest(query, reach);
      ASSERT_EQ(found != nullptr, expected != nullptr);
      if (found != nullptr) {
        ASSERT_EQ(found->point.p, expected->p);
      }
    }
  }
}

TEST(PointMap, EmptyMapHasNoNeighbour) {
  EXPECT_EQ(PointMap(kRadius).nearest({{0, 0}, kNoNormal}, 10.0), nullptr);
}

TEST(PointMap, PointsOfAWallFormItsLine) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.01);
  PointMap map(kRadius);
  for (int i = 0; i < 100; ++i) {
    map.add({{0.05 * i, 2.0 + noise(random)}, {0, -1}});
  }
  // The line through 11 points of 1 cm noise over 0.5 m: 3 mm across, 1.1 degrees (one sigma); all
  // hundred lines stay within four sigma.
  expect_lines_along_wall(map, 8.0, 0.02);
}

TEST(PointMap, TheTwoSidesOfAThinWallAreTwoLines) {
  PointMap map(kRadius);
  for (int i = 0; i < 40; ++i) {
    map.add({{0.05 * i, 0.00}, {0, -1}});
    map.add({{0.05 * i, 0.08}, {0, 1}});
  }
  for (const PointMap::Landmark& landmark : map.landmarks()) {
    ASSERT_TRUE(landmark.is_on_line());
    EXPECT_NEAR(landmark.centre.y(), landmark.point.p.y(), 1e-12);
    EXPECT_NEAR(landmark.normal.dot(landmark.point.normal), 1.0, 1e-12);
  }
  const PointMap::Landmark* upper = map.nearest({{1.0, 0.01}, {0, 1}}, 0.5);
  ASSERT_NE(upper, nullptr);
  EXPECT_EQ(upper->point.p.y(), 0.08);
}

TEST(PointMap, ABlobIsNoLine) {
  PointMap map(kRadius);
  for (const SurfacePoint& point : random_points(60, 4, 0.15)) {
    map.add({point.p, kNoNormal});
  }
  for (const PointMap::Landmark& landmark : map.landmarks()) {
    EXPECT_FALSE(landmark.is_on_line());
    EXPECT_EQ(landmark.centre, landmark.point.p);
  }
}

TEST(PointMap, LinesDoNotDependOnWhereTheMapLies) {
  const Eigen::Vector2d far(576.5, -1234.5);  // the odometry of one recording starts like this
  PointMap here(kRadius);
  PointMap there(kRadius);
  for (const SurfacePoint& point : random_points(500, 5, 1.0)) {
    here.add(point);
    there.add({point.p + far, point.normal});
  }
  for (std::size_t i = 0; i < here.landmarks().size(); ++i) {
    EXPECT_LT((here.landmarks()[i].centre + far - there.landmarks()[i].centre).norm(), 1e-9);
    EXPECT_EQ(here.landmarks()[i].is_on_line(), there.landmarks()[i].is_on_line());
  }
}

TEST(PointMap, LooksAtTheSameWallSharpenItsLineAndAddNothing) {
  std::mt19937 random(6);
  std::normal_distribution<double> noise(0.0, 0.01);
  PointMap map(kRadius);
  const auto look = [&](const auto& take) {
    for (int i = 0; i < 100; ++i) {
      take(SurfacePoint{{0.05 * i, 2.0 + noise(random)}, {0, -1}});
    }
  };
  look([&](const SurfacePoint& point) { map.add(point); });
  for (int i = 0; i < 49; ++i) {
    look([&](const SurfacePoint& point) { map.refine(point); });
  }
  // 50 looks divide 3 mm and 1.1 degrees of one look by 7, and those of the wall's ends, whose
  // lines hang over, by less: they have half the points over half the way. Four sigma of theirs.
  EXPECT_EQ(map.landmarks().size(), 100U);
  expect_lines_along_wall(map, 2.0, 0.0025);
}

TEST(PointMap, TheOtherSideOfAThinWallDoesNotSharpenALine) {
  PointMap map(kRadius);
  for (int i = 0; i < 40; ++i) {
    map.add({{0.05 * i, 0.00}, {0, -1}});
  }
  for (int i = 0; i < 40; ++i) {
    map.refine({{0.05 * i, 0.08}, {0, 1}});
  }
  for (const PointMap::Landmark& landmark : map.landmarks()) {
    EXPECT_EQ(landmark.centre.y(), 0.0);
  }
}

TEST(PointMap, LeavesOutWhatIsNotFinite) {
  PointMap map(kRadius);
  map.add({{std::numeric_limits<double>::quiet_NaN(), 0.0}, kNoNormal});
  map.add({{0.0, std::numeric_limits<double>::infinity()}, kNoNormal});
  EXPECT_TRUE(map.landmarks().empty());
  map.add({{0.0, 0.0}, {0, 1}});
  map.refine({{std::numeric_limits<double>::quiet_NaN(), 0.0}, kNoNormal});
  EXPECT_EQ(map.landmarks()[0].centre, Eigen::Vector2d(0, 0));
}

}  // namespace
}  // namespace nodmap::slam2d
