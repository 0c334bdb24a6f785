// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/surroundings/surroundings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "modules/navigator/behaviours/corridor.hpp"
#include "modules/navigator/geofence.hpp"
#include "modules/navigator/ground/test/profile.hpp"
#include "modules/navigator/local_map/test/scanned_ground.hpp"
#include "modules/navigator/people/test/walking_scene.hpp"

namespace nodmap::navigator {
namespace surroundings_test {

using geometry::deg_to_rad;
using test::at;

// A situation with these points in the obstacle map.
Situation with(const Points& points_base) {
  Situation now;
  now.stamp = at(1.0);
  now.max_forward_mps = 1.0;
  now.points_base = points_base;
  return now;
}

bool has_point_near(const Points& points, const Eigen::Vector2d& p, double radius_m) {
  return std::ranges::any_of(points, [&](const auto& q) { return (q - p).norm() < radius_m; });
}

TEST(Surroundings, WithoutScansThereIsOnlyTheObstacleMap) {
  Surroundings surroundings{{}};
  const Points points{{1.0, 0.5}, {-0.6, 0.2}};
  Situation now = with(points);
  surroundings.complete(now);
  EXPECT_EQ(now.points_base, points);
  EXPECT_EQ(now.local_map, nullptr);
  EXPECT_EQ(now.max_forward_mps, 1.0);
  EXPECT_TRUE(now.people.empty());
}

TEST(Surroundings, ObstaclesOfTheLocalMapAreJoined) {
  Surroundings surroundings{{}};
  const test::Ground ground{{{{0.9, -0.2}, {1.1, 0.2}, 0.2}}};
  for (double deg = -60.0; deg <= 5.0; deg += 1.5) {
    surroundings.add_scan(test::scan_of(ground, {}, deg_to_rad(deg)), {}, false);
  }
  Situation now = with({{3.0, 0.0}});
  now.T_odom_base = {-1.0, 0.0, 0.0};  // where no floor was seen
  Situation held = now;
  surroundings.complete(now);
  EXPECT_TRUE(has_point_near(now.points_base, {3.0, 0.0}, 1e-9));
  EXPECT_TRUE(has_point_near(now.points_base, {1.9, 0.0}, 0.05)) << "two cells";
  EXPECT_EQ(now.local_map, &surroundings.local_map());
  EXPECT_TRUE(now.needs_seen_floor());
  EXPECT_FALSE(now.unseen_ahead_base.empty());
  for (const Eigen::Vector2d& p : now.unseen_ahead_base) {
    EXPECT_GT(p.x(), robot::Body{}.footprint().half_length_m);
  }
  EXPECT_LT(now.unseen_ahead_base.size(), now.doubtful_base.size()) << "some is beside it";

  held.laser_is_held = true;
  surroundings.complete(held);
  EXPECT_TRUE(has_point_near(held.points_base, {1.9, 0.0}, 0.05));
  EXPECT_EQ(held.local_map, &surroundings.local_map());
  EXPECT_FALSE(held.needs_seen_floor());
  EXPECT_TRUE(held.doubtful_base.empty());
  EXPECT_TRUE(held.unseen_ahead_base.empty());
}

TEST(Surroundings, TheGeofenceStandsWhereThePoseInMapSays) {
  Surroundings surroundings{{}};
  const Geofence fence("POLYGON((-2 -2, 2 -2, 2 2, -2 2))");
  Situation now = with({});
  now.geofence = &fence;
  now.T_odom_base = {5.0, 0.0, 0.3};
  now.T_map_odom = {-4.5, 0.2, 0.1};
  surroundings.complete(now);
  const geometry::SE2 T_map_base = now.T_map_odom * now.T_odom_base;
  ASSERT_FALSE(now.points_base.empty());
  for (const Eigen::Vector2d& p_base : now.points_base) {
    const Eigen::Vector2d p_map = T_map_base * p_base;
    EXPECT_NEAR(p_map.cwiseAbs().maxCoeff(), 2.0, 1e-9) << p_map.transpose();
  }
}

// To the obstacle map a ramp of 12 degrees is an obstacle from 0.2 m behind its foot on.
TEST(Surroundings, ARampIsNoObstacleButSlowsTheRobotDown) {
  const double rise_m = 2.0 * std::tan(deg_to_rad(12.0));
  test::NoddingRobot robot({{{-40.0, 0.0}, {1.4, 0.0}, {3.4, rise_m}, {40.0, rise_m}}}, 0.01);
  const NavigatorParams params;
  Surroundings surroundings(params);
  for (int i = 0; robot.x() < 0.5; ++i) {
    const scan::Scan scan = robot.step(i < 146 ? 0.0 : 0.3);  // after two sweeps it drives
    surroundings.add_scan(scan, robot.T_odom_base(), false);
  }
  const Eigen::Vector2d on_ramp(1.6 - robot.x(), 0.0);
  const Eigen::Vector2d beside(-0.3, 1.5);  // the laser does not look there
  Situation now = with({on_ramp, beside});
  now.T_odom_base = robot.T_odom_base();
  surroundings.complete(now);
  EXPECT_EQ(now.max_forward_mps, params.local_map.ground.sloped_mps);
  EXPECT_FALSE(has_point_near(now.points_base, on_ramp, 0.02));
  EXPECT_TRUE(has_point_near(now.points_base, beside, 1e-9));
  Situation slow = with({});
  slow.T_odom_base = robot.T_odom_base();
  slow.max_forward_mps = 0.1;
  surroundings.complete(slow);
  EXPECT_EQ(slow.max_forward_mps, 0.1);
}

// Somebody crosses from right to left, 2.2 m ahead. The wall is no part of them.
TEST(Surroundings, PeopleAreTracksAndNoPoints) {
  Surroundings surroundings{{}};
  const Eigen::Vector2d velocity(0.0, 1.0);
  test::WalkingScene scene{{{{2.2, -3.5}, 0.25, 1.7}}, 4.0};
  double time_s = 0.0;
  for (; time_s < 3.8; time_s += test::kScanS) {
    surroundings.add_scan(scene.scan(at(time_s), {}, test::nodding_pitch_rad(time_s)), {}, false);
    scene.pillars[0].center += test::kScanS * velocity;
  }
  const Eigen::Vector2d person = scene.pillars[0].center;
  Situation now = with({person, person - 0.5 * velocity, {4.0, 0.0}});
  now.stamp = at(time_s);
  surroundings.complete(now);
  ASSERT_EQ(now.people.size(), 1U);
  EXPECT_LT((now.people[0].position - person).norm(), 1.25 * 0.0123);  // measured 12.3 mm
  EXPECT_FALSE(has_point_near(now.points_base, person, 1e-9));
  EXPECT_FALSE(has_point_near(now.points_base, person - 0.5 * velocity, 1e-9));
  EXPECT_TRUE(has_point_near(now.points_base, {4.0, 0.0}, 1e-9));
}

// A post of 3 cm stands 7.5 cm beside the robot's rear quarter, where the laser saw it before the
// robot drove past it. Both maps have it. Somebody walks by, 32 cm from the post. The robot must
// not turn its corner into the post then.
TEST(Surroundings, APostBesideTheRobotStaysWhenSomebodyWalksBy) {
  const NavigatorParams params;
  const auto free_rotation_after = [&](double until_s) {
    Surroundings surroundings(params);
    test::WalkingScene scene{{{{-0.12, 0.24}, 0.015, 1.0}, {{4.0, 0.56}, 0.25, 1.7}}, 12.0};
    geometry::SE2 T_odom_base{-2.5, 0.0, 0.0};
    for (double time_s = 0.0; time_s < until_s; time_s += test::kScanS) {
      T_odom_base.x = std::clamp(0.5 * (time_s - 1.0) - 2.5, -2.5, 0.0);
      scene.pillars[1].center.x() = std::min(4.0, 4.0 - (time_s - 8.0));
      const scan::Scan scan =
          scene.scan(at(100.0 + time_s), T_odom_base, test::nodding_pitch_rad(time_s));
      surroundings.add_scan(scan, T_odom_base, false);
    }
    Situation now = with({{-0.12, 0.24}});
    now.stamp = at(100.0 + until_s);
    surroundings.complete(now);
    return std::pair(free_rotation(now.points_base, Side::kRight, params.robot.body.footprint(), 0),
                     now.people.size());
  };
  const auto [free_before_rad, people_before] = free_rotation_after(8.0);
  const auto [free_after_rad, people_after] = free_rotation_after(12.2);
  EXPECT_EQ(people_before, 0U);
  ASSERT_EQ(people_after, 1U);
  ASSERT_LT(free_before_rad, 0.5);
  EXPECT_EQ(free_after_rad, free_before_rad);
}

// Somebody crosses. Then the robot is before a ramp, where nobody is tracked.
TEST(Surroundings, WhoeverIsNotTrackedBeforeARampIsLost) {
  Surroundings surroundings{{}};
  test::WalkingScene scene{{{{2.2, -3.5}, 0.25, 1.7}}, 4.0};
  double time_s = 0.0;
  for (; time_s < 3.8; time_s += test::kScanS) {
    surroundings.add_scan(scene.scan(at(time_s), {}, test::nodding_pitch_rad(time_s)), {}, false);
    scene.pillars[0].center.y() += test::kScanS;
  }
  const auto complete = [&] {
    Situation now = with({});
    now.stamp = at(time_s);
    surroundings.complete(now);
    return now;
  };
  ASSERT_EQ(complete().people.size(), 1U);
  const double rise_m = 2.0 * std::tan(deg_to_rad(12.0));
  test::NoddingRobot robot({{{-40.0, 0.0}, {1.4, 0.0}, {3.4, rise_m}, {40.0, rise_m}}}, 0.01);
  double since_ramp_s = 0.0;
  for (const double end_s = time_s + 25.0; time_s < end_s; time_s += test::kScanS) {
    scan::Scan scan = robot.step(robot.x() < 0.5 && time_s > 6.0 ? 0.3 : 0.0);
    scan.stamp = at(time_s);
    surroundings.add_scan(scan, robot.T_odom_base(), false);
    if (!surroundings.local_map().ground().is_level()) {
      since_ramp_s += test::kScanS;
    }
  }
  ASSERT_GT(since_ramp_s, 15.0);
  EXPECT_TRUE(complete().people.empty());
}

TEST(Surroundings, ItWaitsForASecondAfterSomethingHasComeNearer) {
  Surroundings surroundings{{}};
  for (const std::int64_t sweep : {0, 2}) {  // all directions ahead are seen
    Situation now = with({{1.0, 0.0}});
    now.sweep_count = sweep;
    surroundings.complete(now);
    EXPECT_FALSE(surroundings.reason_to_wait(now.stamp));
  }
  Situation now = with({{0.8, 0.0}});
  now.sweep_count = 2;
  surroundings.complete(now);
  EXPECT_EQ(surroundings.reason_to_wait(now.stamp), Reason(Why::kApproach));
  EXPECT_FALSE(surroundings.reason_to_wait(now.stamp + 2s));
}

// 0.6 m beyond the turning circle of 0.28 m, and 0.5 m more at 1 m/s.
TEST(Surroundings, TheFasterItDrivesTheEarlierItWaitsForWhatComesNearer) {
  for (const double forward_mps : {0.0, 1.0}) {
    Surroundings surroundings{{}};
    for (const std::int64_t sweep : {0, 2}) {
      Situation now = with({{1.3, 0.0}});
      now.sweep_count = sweep;
      surroundings.complete(now);
    }
    Situation now = with({{1.2, 0.0}});
    now.sweep_count = 2;
    now.forward_mps = forward_mps;
    surroundings.complete(now);
    EXPECT_EQ(surroundings.reason_to_wait(now.stamp).has_value(), forward_mps > 0.0);
  }
}

TEST(Surroundings, AfterAShortGapWhatWasNotSeenBeforeIsLookedAtAgain) {
  Surroundings surroundings{{}};
  const auto has_seen_ahead = [&](std::int64_t sweep) {
    Situation now = with({});
    now.sweep_count = sweep;
    surroundings.complete(now);
    return now.has_seen(0.0);
  };
  EXPECT_FALSE(has_seen_ahead(0));
  EXPECT_FALSE(has_seen_ahead(1));
  surroundings.miss_scans();
  EXPECT_FALSE(has_seen_ahead(2));
  EXPECT_FALSE(has_seen_ahead(3));
  EXPECT_TRUE(has_seen_ahead(4));
}

TEST(Surroundings, AfterOneShortGapItKnowsWhatWasSeenAfterTwoItDoesNot) {
  Surroundings surroundings{{}};
  const auto complete = [&](std::int64_t sweep) {
    Situation now = with({});
    now.sweep_count = sweep;
    surroundings.complete(now);
    return now;
  };
  complete(0);
  complete(2);
  surroundings.miss_scans();
  EXPECT_EQ(complete(2).max_forward_mps, 0.5);
  EXPECT_TRUE(complete(2).has_seen(0.0));
  surroundings.miss_scans();
  EXPECT_EQ(complete(2).max_forward_mps, 1.0) << "it does not drive before it has looked";
  EXPECT_FALSE(complete(2).has_seen(0.0));
}

// A situation of a robot whose laser is held: its head makes no sweeps.
Situation held(const Points& points_base) {
  Situation now = with(points_base);
  now.laser_is_held = true;
  return now;
}

TEST(Surroundings, WithALevelLaserAShortGapIsOverWithTheNextScan) {
  Surroundings surroundings{{}};
  for (int gap = 0; gap < 3; ++gap) {
    Situation now = held({});
    surroundings.complete(now);
    EXPECT_EQ(now.max_forward_mps, 1.0);
    surroundings.miss_scans();
  }
}

TEST(Surroundings, WithALevelLaserItWaitsForWhatComesNearer) {
  Surroundings surroundings{{}};
  Situation now = held({{1.0, 0.0}});
  surroundings.complete(now);
  EXPECT_FALSE(surroundings.reason_to_wait(now.stamp));
  now = held({{0.8, 0.0}});
  surroundings.complete(now);
  EXPECT_EQ(surroundings.reason_to_wait(now.stamp), Reason(Why::kApproach));
}

}  // namespace surroundings_test
}  // namespace nodmap::navigator
