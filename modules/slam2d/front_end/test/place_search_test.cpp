// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "modules/slam2d/test/drawn_world.hpp"
#include "modules/slam2d/test/track.hpp"

namespace nodmap::slam2d {
namespace place_search_test {

using geometry::SE2;
using test::kPeriod;
using test::Scanner;
using test::track;

TEST(Slam2d, ARotationThatOdometryMissedIsFound) {
  test::Slam slam;
  Scanner scanner;
  ASSERT_TRUE(track(slam, scanner.scan(test::room(), {}), {}));
  const SE2 truth{0.1, 0.0, geometry::deg_to_rad(50.0)};
  const auto update =
      track(slam, scanner.scan(test::room(), truth, time::Timestamp(kPeriod)), {0.1, 0.0, 0.0});
  ASSERT_TRUE(update);
  EXPECT_EQ(slam.metrics().searches.found, 1);
  // Measured against a map of a single scan: 5.2 mm and 0.127 degrees.
  EXPECT_LT(distance_m(update->T_map_base, truth), 0.0064);
  EXPECT_NEAR(update->T_map_base.yaw, truth.yaw, geometry::deg_to_rad(0.158));
}

// A round room of 2 m whose wall is folded so little that nothing lies far behind it.
test::FloorPlan folded_room() {
  const std::vector<double> radii_m{1.77, 2.12, 1.91, 2.19, 1.79, 1.93, 1.91, 1.97,
                                    2.20, 2.11, 2.04, 2.12, 1.86, 2.09, 1.80, 1.84,
                                    1.80, 2.15, 1.99, 1.97, 2.08, 1.76, 1.79, 2.12};
  const auto corner = [&](std::size_t i) {
    const double angle =
        2.0 * geometry::kPi * static_cast<double>(i) / static_cast<double>(radii_m.size());
    return Eigen::Vector2d(radii_m[i % radii_m.size()] * std::cos(angle),
                           radii_m[i % radii_m.size()] * std::sin(angle));
  };
  test::FloorPlan plan;
  for (std::size_t i = 0; i < radii_m.size(); ++i) {
    plan.push_back({corner(i), corner(i + 1)});
  }
  return plan;
}

// Odometry is late in a fast rotation. The match from there ends in a wrong fold of the wall, and
// the scan contradicts nothing that was seen before.
TEST(Slam2d, ARotationThatOdometryMissedIsFoundWhereNothingIsContradicted) {
  for (const double missed_rad : {geometry::deg_to_rad(18.0), geometry::deg_to_rad(-18.0)}) {
    test::Slam slam;
    Scanner scanner;
    ASSERT_TRUE(track(slam, scanner.scan(folded_room(), {}), {}));
    const SE2 truth{0.05, 0.0, 0.05};
    const auto update = track(slam, scanner.scan(folded_room(), truth, time::Timestamp(kPeriod)),
                              {0.05, 0.0, truth.yaw - missed_rad});
    ASSERT_TRUE(update);
    EXPECT_EQ(slam.metrics().searches.found, 1);
    EXPECT_EQ(update->state, PoseState::kTracking);
    // As the match from the true pose, measured: 1.2 mm and 0.083 degrees.
    EXPECT_LT(distance_m(update->T_map_base, truth), 0.0015);
    EXPECT_NEAR(update->T_map_base.yaw, truth.yaw, geometry::deg_to_rad(0.105));
  }
}

// The rotation is missed as in the first test, but only a piece of a wall is in view, which fits
// many places.
TEST(Slam2d, AScanWithFewPointsStartsNoSearch) {
  test::Slam slam;
  Scanner scanner;
  ASSERT_TRUE(track(slam, scanner.scan(test::room(), {}), {}));
  const SE2 truth{0.1, 0.0, geometry::deg_to_rad(50.0)};
  scan::Scan scan = scanner.scan(test::room(), truth, time::Timestamp(kPeriod));
  constexpr std::size_t kFirst = 40;
  constexpr std::size_t kLast = 65;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (i < kFirst || i > kLast) {
      scan.ranges_m[i] = std::numeric_limits<float>::infinity();
    }
  }
  const SE2 odom{0.1, 0.0, 0.0};
  const auto update = track(slam, scan, odom);
  ASSERT_TRUE(update);
  EXPECT_EQ(slam.metrics().searches.made, 0);
  EXPECT_NE(update->state, PoseState::kTracking);
  EXPECT_EQ(update->T_map_base.x, odom.x);
}

// Posts of 15 cm that stand about at random, as in BARN's worlds.
test::FloorPlan posts(std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> x(0.6, 5.0);
  std::uniform_real_distribution<double> y(-2.0, 2.0);
  constexpr int kNumSides = 8;
  constexpr double kRadiusM = 0.075;
  test::FloorPlan plan;
  for (int post = 0; post < 40; ++post) {
    const Eigen::Vector2d center(x(engine), y(engine));
    const auto corner = [&](int i) -> Eigen::Vector2d {
      const double angle_rad = 2.0 * geometry::kPi * i / kNumSides;
      return center + kRadiusM * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
    };
    for (int i = 0; i < kNumSides; ++i) {
      plan.push_back({corner(i), corner(i + 1)});
    }
  }
  return plan;
}

// The robot drives towards the end of a field of posts, and sees ever fewer of them, most of which
// were hidden before: a scan fits at many poses.
TEST(Slam2d, NewPostsDoNotMoveThePoseAwayFromOdometry) {
  constexpr double kTurnedRad = 0.25;  // a match near odometry may turn the pose by 0.2
  int num_turned = 0;
  for (std::uint64_t seed = 1000; seed < 1040; ++seed) {
    test::Slam slam;
    Scanner scanner;
    const test::FloorPlan plan = posts(seed);
    bool is_turned = false;
    for (int step = 0; step < 6; ++step) {
      const SE2 truth{0.9 * step, 0.0, 0.0};
      const time::Timestamp stamp(kPeriod * step);
      const auto update = track(slam, scanner.scan(plan, truth, stamp), truth);
      is_turned |= update && std::abs(update->T_map_base.yaw) > kTurnedRad;
    }
    num_turned += is_turned ? 1 : 0;
  }
  // Measured: none as compiled by g++, 2 as by clang, because a scan that seems to contradict the
  // map may still turn the pose; 4 or more if matches far from odometry count.
  EXPECT_LE(num_turned, 2);
}

// There are two bays side by side, 1.1 m apart. From the first bay the wall between them hides the
// second, so that nearly everything that the robot sees in the second is new, and would also fit
// the first.
TEST(Slam2d, ASimilarPlaceNearbyDoesNotReplaceThePoseByOdometry) {
  test::Slam slam;
  Scanner scanner;
  const test::FloorPlan bays{{{0.0, -1.5}, {0.0, 1.5}},
                             {{1.1, -1.5}, {1.1, 1.5}},
                             {{2.2, -1.5}, {2.2, 1.5}},
                             {{0.0, -1.5}, {2.2, -1.5}}};
  const SE2 first{0.55, 0.0, -geometry::kPi / 2};
  const SE2 second{1.65, 0.0, -geometry::kPi / 2};
  ASSERT_TRUE(track(slam, scanner.scan(bays, first), first));
  const auto update = track(slam, scanner.scan(bays, second, time::Timestamp(kPeriod)), second);
  ASSERT_TRUE(update);
  EXPECT_EQ(slam.metrics().searches.made, 1);
  EXPECT_NE(update->state, PoseState::kTracking);
  EXPECT_LT(distance_m(update->T_map_base, second), 0.1);  // by odometry, or matched near it
}

TEST(Slam2d, WithoutAnyMatchTheRobotIsLostAndTheMapContinuesFromOdometry) {
  test::Slam slam;
  Scanner scanner;
  ASSERT_TRUE(track(slam, scanner.scan(test::room(), {}), {}));
  // The robot is carried to a place where nothing of the map is in sight.
  const test::FloorPlan elsewhere{{{52, -2}, {52, 2}}, {{52, 2}, {48, 3}}, {{48, -2}, {52, -2}}};
  const SE2 carried{50.0, 0.0, 0.0};
  const auto lost =
      track(slam, scanner.scan(elsewhere, carried, time::Timestamp(kPeriod)), carried);
  ASSERT_TRUE(lost);
  EXPECT_EQ(lost->state, PoseState::kLost);
  EXPECT_EQ(lost->T_map_base.x, 50.0);
  const auto again =
      track(slam, scanner.scan(elsewhere, carried, time::Timestamp(2 * kPeriod)), carried);
  ASSERT_TRUE(again);
  // The scan is matched, but the pose is DEGRADED: the relative pose of the new piece of map and
  // the old one is not known.
  EXPECT_EQ(again->state, PoseState::kDegraded);
  EXPECT_GT(again->covariance(0, 0), 1.0);
}

// The robot drives past an obstacle and then sees another one, 1.2 m wide, which fits nothing in
// the map. For a while odometry alone is good enough.
TEST(Slam2d, AnAreaSeenForTheFirstTimeIsAddedByOdometry) {
  test::Slam slam;
  Scanner scanner;
  const test::FloorPlan obstacles{{{3, -1}, {3, 0}}, {{7, 1.4}, {7, 2.6}}};
  const SE2 before;
  ASSERT_TRUE(track(slam, scanner.scan({obstacles[0]}, before), before));
  const SE2 behind{4.0, 2.0, 0.0};
  const auto first = track(slam, scanner.scan(obstacles, behind, time::Timestamp(kPeriod)), behind);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->state, PoseState::kOdometry);
  EXPECT_TRUE(first->is_keyframe);
  EXPECT_GT(first->covariance(0, 0), 0.016 * std::hypot(4.0, 2.0) - 1e-9);
  const auto again =
      track(slam, scanner.scan(obstacles, behind, time::Timestamp(2 * kPeriod)), behind);
  ASSERT_TRUE(again);
  EXPECT_LE(again->state, PoseState::kDegraded);
  EXPECT_LT(distance_m(again->T_map_base, behind), 0.02);  // measured 0
}

}  // namespace place_search_test
}  // namespace nodmap::slam2d
