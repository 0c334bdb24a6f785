// SPDX-License-Identifier: BSD-3-Clause
// What the navigator decides on open floor that the laser has seen all around.
#include "modules/navigator/navigator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "modules/navigator/local_map/test/scanned_ground.hpp"
#include "modules/navigator/people/test/walking_scene.hpp"

namespace nodmap::navigator {
namespace navigator_test {

constexpr double kStepS = 0.01332;

struct NavigatorTest : testing::Test {
  NavigatorTest() {
    now.max_forward_mps = 1.0;
    test::look_around(navigator, {});
  }

  // One decision, a scan later. In the meantime the laser has seen what is ahead.
  Decision decide(const std::optional<Eigen::Vector2d>& goal_odom) {
    const geometry::SE2 T_base_odom = now.T_odom_base.inverse();
    now.stamp += time::from_seconds(kStepS);
    now.sweep_count += 2;
    now.goal.reset();
    if (goal_odom) {
      now.goal = GoalInBase{T_base_odom * *goal_odom, 0.1};
    }
    now.points_base.clear();
    for (const Eigen::Vector2d& p_odom : points_odom) {
      now.points_base.push_back(T_base_odom * p_odom);
    }
    return navigator.decide(now);
  }

  // Drives as decided, exactly.
  void drive(const std::optional<Eigen::Vector2d>& goal_odom) {
    const Decision decision = decide(goal_odom);
    now.forward_mps = decision.forward_mps;
    now.yaw_rate_rad_s = decision.yaw_rate_rad_s;
    now.T_odom_base = now.T_odom_base * geometry::SE2{kStepS * decision.forward_mps, 0.0,
                                                      kStepS * decision.yaw_rate_rad_s};
  }

  NavigatorParams params;
  Navigator navigator{params};
  Situation now;
  Points points_odom;
};

// The goal is behind the robot, so it would rotate.
TEST_F(NavigatorTest, WithoutASpeedFromThePitchControllerItDoesNotMoveToAGoal) {
  now.max_forward_mps = 0.0;
  for (int i = 0; i < 60; ++i) {  // 0.8 s, more than planning takes
    const Decision decision = decide(Eigen::Vector2d(-2.0, 0.0));
    EXPECT_EQ(decision.forward_mps, 0.0);
    EXPECT_EQ(decision.yaw_rate_rad_s, 0.0);
    EXPECT_EQ(decision.reason, Reason(Why::kNoSpeed));
  }
  now.max_forward_mps = 1.0;
  Decision decision;
  for (int i = 0; i < 60; ++i) {
    decision = decide(Eigen::Vector2d(-2.0, 0.0));
  }
  EXPECT_GT(std::abs(decision.yaw_rate_rad_s), 0.1);
}

// At the goal nothing demands a stop, unless something is ahead: from 0.4 m/s even an emergency
// stop takes 2.7 cm, and the front is at 0.225 m. Ordinary brakes take 0.105 m/s in the 0.07 s
// until the base has done what is commanded; from 0.295 m/s the robot stops within 5.9 cm.
TEST_F(NavigatorTest, AtTheGoalItStopsWithOrdinaryBrakesIfTheySuffice) {
  now.forward_mps = 0.4;
  const auto forward_mps = [&](double x, double y) {
    const Decision decision = decide(Eigen::Vector2d(x, y));
    EXPECT_EQ(decision.behaviour, Behaviour::kArrived);
    return decision.forward_mps;
  };
  EXPECT_NEAR(forward_mps(0.09, 0.0), 0.4 - 0.105, 1e-12);
  // It would leave the tolerance of 10 cm: it has 2 cm, or is at its side.
  EXPECT_EQ(forward_mps(-0.08, 0.0), 0.0);
  EXPECT_EQ(forward_mps(0.0, 0.09), 0.0);
  points_odom = {{0.225 + 0.15 + 0.02, 0.0}};
  EXPECT_EQ(forward_mps(0.09, 0.0), 0.0);
}

// They walk at 1.2 m/s towards a robot that drives at up to 1 m/s. Without the planner only
// decide() gives way.
TEST_F(NavigatorTest, IsStationaryBeforeSomebodyWalksIntoIt) {
  params.planner.use = params.planner.roams = false;
  navigator = Navigator(params);
  test::WalkingScene scene{{{{9.0, 0.05}, 0.25, 1.7}}, 30.0};
  const Eigen::Vector2d& person = scene.pillars[0].center;
  double fastest_mps = 0.0;
  while (person.x() - 0.25 - now.T_odom_base.x - 0.5 * params.robot.body.length_m > 0.03) {
    const double time_s = time::seconds(now.stamp.time_since_epoch());
    navigator.add_scan(scene.scan(now.stamp, now.T_odom_base, test::nodding_pitch_rad(time_s)),
                       now.T_odom_base);
    drive({});
    fastest_mps = std::max(fastest_mps, now.forward_mps);
    scene.pillars[0].center.x() -= 1.2 * kStepS;
  }
  EXPECT_GT(fastest_mps, 0.8);
  EXPECT_EQ(now.forward_mps, 0.0);
  EXPECT_EQ(decide({}).reason, Reason(Why::kGivesWay));
}

// Before a step down of 3.5 cm, which is neither floor nor certainly a hole. Brake does not let the
// robot drive there, so Turn must not end there either: the robot would stay for good.
TEST_F(NavigatorTest, TurnsAwayFromWhereBrakeDoesNotLetItDrive) {
  constexpr double kStepM = 0.4;
  params.planner.use = params.planner.roams = false;
  navigator = Navigator(params);
  const test::Ground step{{{{kStepM, -3.0}, {4.0, 3.0}, -0.035}}};
  for (int sweep = 0; sweep < 3; ++sweep) {
    test::look_around(navigator, step);
  }
  for (int i = 0; i < 600; ++i) {  // 8 s
    const double time_s = time::seconds(now.stamp.time_since_epoch());
    navigator.add_scan(test::scan_of(step, now.T_odom_base, test::nodding_pitch_rad(time_s)),
                       now.T_odom_base);
    drive({});
    ASSERT_LT(now.T_odom_base.x, kStepM - params.robot.body.footprint().half_length_m);
  }
  EXPECT_GT(now.T_odom_base.translation().norm(), 1.0);
}

// Where the robot ends that has driven 0.8 m straight to the origin, perhaps rotates there, and
// then gets a goal 0.5 m behind it. It is between two rows of points and before a third one, so it
// can neither rotate nor drive on.
struct BackwardsTest : NavigatorTest {
  double end_x(bool rotates) {
    for (int i = 0; i <= 40; ++i) {
      now.T_odom_base = {-0.8 + 0.02 * i, 0.0, 0.0};
      navigator.add_scan(test::scan_of({}, now.T_odom_base, geometry::deg_to_rad(-60.0)),
                         now.T_odom_base);
      (void)decide(Eigen::Vector2d(3.0, 0.0));
    }
    for (double rad = 0.0; rotates && rad < 2.0 * geometry::kPi; rad += 0.1) {
      now.T_odom_base = {0.0, 0.0, rad};
      (void)decide({});
    }
    now.T_odom_base = {};
    const robot::Footprint body = params.robot.body.footprint();
    const double aside_m = body.half_width_m + 0.04;
    for (double x = -1.5; x < body.half_length_m; x += 0.01) {
      points_odom.emplace_back(x, aside_m);
      points_odom.emplace_back(x, -aside_m);
    }
    for (double y = -aside_m; y < aside_m; y += 0.01) {
      points_odom.emplace_back(body.half_length_m + 0.06, y);
    }
    for (int i = 0; i < 300; ++i) {  // 4 s
      drive(Eigen::Vector2d(-0.5, 0.0));
    }
    return now.T_odom_base.x;
  }
};

TEST_F(BackwardsTest, ItBacksUpOnTheStripThatItHasDriven) {
  EXPECT_LT(end_x(false), -0.3);
}

// A full rotation counts as 25 m of travel, whatever decides meanwhile. What is left of the strip
// is where the body is.
TEST_F(BackwardsTest, ItDoesNotBackUpWhereItHasDrivenLongAgo) {
  EXPECT_GT(end_x(true), -0.1);
}

}  // namespace navigator_test
}  // namespace nodmap::navigator
