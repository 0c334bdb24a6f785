// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/extended_scan.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace nodmap::map_server {
namespace extended_scan_test {

using geometry::deg_to_rad;
using geometry::SE2;

AngleBins bins(double aperture_deg, double resolution_deg) {
  return {deg_to_rad(aperture_deg), deg_to_rad(resolution_deg)};
}

TEST(AngleBins, TheNumberOfBinsFollowsFromApertureAndStep) {
  EXPECT_EQ(bins(180, 1).size(), 181U);
  EXPECT_EQ(bins(180, 0.5).size(), 361U);
  EXPECT_EQ(bins(360, 0.5).size(), 720U);
  EXPECT_EQ(bins(360, 1).size(), 360U);
  EXPECT_EQ(bins(270, 0.25).size(), 1081U);
}

TEST(AngleBins, TheAngleOfABinHasTheIndexOfThatBin) {
  for (const AngleBins& b : {bins(180, 1), bins(360, 0.5), bins(90, 0.25), bins(360, 7)}) {
    for (std::size_t i = 0; i < b.size(); ++i) {
      EXPECT_EQ(b.index(geometry::normalize_angle(b.angle_rad(i))), i);
      // Anywhere within the bin, except for rounding at its borders.
      EXPECT_EQ(b.index(geometry::normalize_angle(b.angle_rad(i) + 0.499 * b.step_rad())), i);
      EXPECT_EQ(b.index(geometry::normalize_angle(b.angle_rad(i) - 0.499 * b.step_rad())), i);
    }
  }
}

TEST(AngleBins, OutsideTheApertureThereIsNoBin) {
  EXPECT_EQ(bins(180, 1).index(deg_to_rad(91)), std::nullopt);
  EXPECT_EQ(bins(180, 1).index(deg_to_rad(-91)), std::nullopt);
  EXPECT_EQ(bins(180, 1).index(deg_to_rad(180)), std::nullopt);
}

TEST(AngleBins, BothSidesOfStraightBackAreInOneBin) {
  const AngleBins b = bins(360, 1);
  EXPECT_EQ(b.index(deg_to_rad(179.9)), b.index(deg_to_rad(-179.9)));
  EXPECT_EQ(b.index(geometry::kPi), b.index(-geometry::kPi));
}

TEST(AngleBins, NotANumberHasNoBin) {
  EXPECT_EQ(bins(360, 1).index(std::numeric_limits<double>::quiet_NaN()), std::nullopt);
  EXPECT_EQ(bins(360, 1).index(std::numeric_limits<double>::infinity()), std::nullopt);
}

void put(ExtendedScan& map, const EgoPoint& point) {
  const auto bin = map.bins().index(point.bearing_rad);
  ASSERT_TRUE(bin);
  map[*bin] = point;
}

std::size_t count_valid(const ExtendedScan& map) {
  return static_cast<std::size_t>(
      std::ranges::count_if(map.points(), [](const EgoPoint& p) { return p.valid; }));
}

ExtendedScan circle_of_points(Relevance relevance, double resolution_deg) {
  ExtendedScan map(AngleBins(deg_to_rad(360), deg_to_rad(resolution_deg)), relevance);
  std::mt19937 random(17);
  std::uniform_real_distribution<double> distance(0.5, 8.0);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double angle = map.bins().angle_rad(i);
    map[i] =
        EgoPoint::at(distance(random) * Eigen::Vector2d(std::cos(angle), std::sin(angle)), 0.2);
  }
  return map;
}

// 1e-9 as the requirement says.
TEST(ExtendedScan, CartesianAndPolarAgreeAfterTenThousandUpdates) {
  ExtendedScan map = circle_of_points(Relevance::kNearest, 0.5);
  std::mt19937 random(18);
  std::normal_distribution<double> step(0.0, 0.02);
  for (int i = 0; i < 10'000; ++i) {
    map.transform({step(random), step(random), step(random)});
    if (i < 9'000) {  // collisions reduce the number of points, so add new ones
      put(map, EgoPoint::at({5.0 + 50.0 * step(random), 100.0 * step(random)}, 0.2));
    }
  }
  std::size_t checked = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i].valid) {
      const EgoPoint& p = map[i];
      EXPECT_LT(std::abs(p.distance_m - std::hypot(p.p_base.x(), p.p_base.y())), 1e-9);
      EXPECT_LT(std::abs(p.bearing_rad - std::atan2(p.p_base.y(), p.p_base.x())), 1e-9);
      EXPECT_EQ(map.bins().index(p.bearing_rad), i);
      ++checked;
    }
  }
  EXPECT_GT(checked, 50U);
}

// The robot drives a 4 x 1 m rectangle, in steps, and turns left at its corners; poses are exact.
std::vector<SE2> square_drive() {
  std::vector<SE2> poses{{0, 0, 0}};
  for (const double side : {4.0, 1.0, 4.0, 1.0}) {
    for (int i = 0; i < 100; ++i) {
      poses.push_back(poses.back() * SE2{side / 100, 0, 0});
    }
    for (int i = 0; i < 90; ++i) {
      poses.push_back(poses.back() * SE2{0, 0, deg_to_rad(1)});
    }
  }
  return poses;
}

TEST(ExtendedScan, AfterARectangularDrivePointsAreBackInPlace) {
  ExtendedScan map(AngleBins(deg_to_rad(360), deg_to_rad(1)), Relevance::kNearest);
  // Outside the rectangle, so far apart that no two of them share a bin during the drive.
  const std::vector<Eigen::Vector2d> walls = {{7, 0.5}, {2, 4}, {-3, 0.5}, {2, -3}};
  for (const auto& p : walls) {
    put(map, EgoPoint::at(p, 0.2));
  }
  const auto poses = square_drive();
  for (std::size_t i = 1; i < poses.size(); ++i) {
    map.transform(poses[i].inverse() * poses[i - 1]);
  }
  ASSERT_EQ(count_valid(map), walls.size());
  for (const auto& p : walls) {
    const EgoPoint expected = EgoPoint::at(p, 0.2);
    const auto found = std::ranges::min_element(
        map.points(), {}, [&](const EgoPoint& q) { return q.valid ? (q.p_base - p).norm() : 1e9; });
    // One millimetre and one bin, as the requirement says.
    EXPECT_LT((found->p_base - p).norm(), 1e-3);
    EXPECT_NEAR(found->bearing_rad, expected.bearing_rad, deg_to_rad(1));
  }
}

// Eq. 2 applied with the robot's own rotation and displacement moves the map in the wrong
// direction.
TEST(ExtendedScan, TheNaiveSignOfEquation2IsWrongByMetres) {
  ExtendedScan map(AngleBins(deg_to_rad(360), deg_to_rad(1)), Relevance::kNearest);
  ExtendedScan naive = map;
  const SE2 T_odom_start{0, 0, 0};
  const SE2 T_odom_end = T_odom_start * SE2{1.0, 0, 0} * SE2{0, 0, deg_to_rad(-10)};
  const Eigen::Vector2d wall(4.0, 0.0);
  put(map, EgoPoint::at(wall, 0.2));
  put(naive, EgoPoint::at(wall, 0.2));
  map.transform(T_odom_end.inverse() * T_odom_start);
  naive.transform(T_odom_start.inverse() * T_odom_end);  // Eq. 2 with the robot's displacement
  const auto only_point = [](const ExtendedScan& m) {
    return std::ranges::find_if(m.points(), [](const EgoPoint& p) { return p.valid; })->p_base;
  };
  const Eigen::Vector2d truth = T_odom_end.inverse() * wall;
  EXPECT_LT((only_point(map) - truth).norm(), 1e-9);
  // A turn to the right moves a point ahead to the left.
  EXPECT_GT(only_point(map).y(), 0.1);
  // Wrong by twice the distance driven, 1 m, and also by twice the rotation.
  EXPECT_GT((only_point(naive) - truth).norm(), 2.0);
}

// The oracle moves the points one by one and picks the winner of each bin from the whole list.
void expect_merge_as_oracle(Relevance relevance) {
  ExtendedScan map = circle_of_points(relevance, 2.0);
  const ExtendedScan before = map;
  const SE2 shift{-1.3, 0.4, deg_to_rad(25)};
  map.transform(shift);
  for (std::size_t bin = 0; bin < map.size(); ++bin) {
    std::vector<double> candidates;
    for (const EgoPoint& p : before.points()) {
      const Eigen::Vector2d q = shift * p.p_base;
      if (map.bins().index(std::atan2(q.y(), q.x())) == bin) {
        candidates.push_back(q.norm());
      }
    }
    ASSERT_EQ(map[bin].valid, !candidates.empty()) << "bin " << bin;
    if (!candidates.empty()) {
      const auto [low, high] = std::ranges::minmax(candidates);
      EXPECT_NEAR(map[bin].distance_m, relevance == Relevance::kNearest ? low : high, 1e-12);
    } else {
      EXPECT_EQ(map[bin].distance_m, map.dummy().distance_m);
    }
  }
  EXPECT_LT(count_valid(map), map.size());  // there were bins with several points, and empty ones
}

TEST(ExtendedScan, OfPointsInOneBinTheNearestIsKeptAndEmptyBinsGetDummies) {
  expect_merge_as_oracle(Relevance::kNearest);
}

TEST(ExtendedScan, OfPointsInOneBinTheFarthestIsKeptAndEmptyBinsGetDummies) {
  expect_merge_as_oracle(Relevance::kFarthest);
}

TEST(ExtendedScan, PointsThatLeaveTheApertureAreDropped) {
  ExtendedScan map(AngleBins(deg_to_rad(180), deg_to_rad(1)), Relevance::kNearest);
  put(map, EgoPoint::at({1.0, 0.5}, 0.2));
  put(map, EgoPoint::at({3.0, 0.5}, 0.2));
  map.transform({-2.0, 0.0, 0.0});  // the first is now behind
  EXPECT_EQ(count_valid(map), 1U);
}

TEST(ExtendedScan, ANonFiniteShiftRemovesAllPoints) {
  ExtendedScan map = circle_of_points(Relevance::kNearest, 2.0);
  map.transform({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0});
  EXPECT_EQ(count_valid(map), 0U);
}

}  // namespace extended_scan_test
}  // namespace nodmap::map_server
