// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/passive_safety.hpp"

#include <gtest/gtest.h>

namespace nodmap::navigator {
namespace passive_safety_test {

// Head on: with reaction time T and deceleration a, the robot needs T + (v - 0.05) / a, and drives
// v T + (v^2 - 0.05^2) / 2a meanwhile; the walker comes nearer by his speed. Steps of 50 ms at 2
// m/s and more: 0.15 m.
TEST(PassiveSafety, HeadOnItIsStationaryOnContact) {
  const NavigatorParams params;
  const PassiveSafety safety(params.robot, params.drive, params.people);
  const double a = params.robot.braking.deceleration_mps2;
  const double T = params.drive.reaction_s;
  for (const double v : {0.3, 0.7, 1.2}) {
    for (const double walker_mps : {0.5, 1.4, 2.0}) {
      const double needed_m = v * T + (v * v - 0.0025) / (2.0 * a) +
                              walker_mps * (T + (v - 0.05) / a) + 0.5 * params.robot.body.length_m +
                              0.25 + params.people.margin_m;
      const auto is_safe = [&](double distance_m) {
        return safety.is_safe({v, 0.0}, {{{distance_m, 0.0}, {-walker_mps, 0.0}, 0.25, 0.0, 0.0}});
      };
      EXPECT_FALSE(is_safe(needed_m - 0.15)) << v << ' ' << walker_mps;
      EXPECT_TRUE(is_safe(needed_m + 0.15)) << v << ' ' << walker_mps;
    }
  }
}

TEST(PassiveSafety, StandingIsSafeAndAWalkerWhoLeavesIsNoReasonToStop) {
  const NavigatorParams params;
  const PassiveSafety safety(params.robot, params.drive, params.people);
  EXPECT_TRUE(safety.is_safe({}, {{{0.3, 0.0}, {-1.0, 0.0}, 0.25, 0.1, 0.3}}));
  EXPECT_EQ(safety.safe_factor({0.8, 0.0}, {{{1.2, 0.0}, {1.5, 0.0}, 0.25, 0.05, 0.2}}), 1.0);
  // He crosses ahead, and is gone before the robot is there.
  EXPECT_EQ(safety.safe_factor({0.5, 0.0}, {{{1.0, 0.6}, {0.0, 1.2}, 0.25, 0.05, 0.2}}), 1.0);
  // The corners of a robot that rotates beside somebody count, too.
  const double factor = safety.safe_factor({0.0, 1.0}, {{{0.0, 0.5}, {0.0, -0.8}, 0.2, 0.0, 0.0}});
  EXPECT_LT(factor * params.robot.body.footprint().turning_radius_m(), 0.05);  // stationary
}

// A rotation at w is over after T + (r w - 0.05) / a, r to the corners: by then somebody out of
// sight has walked his speed times that, in whatever direction. Steps of 50 ms at 1.5 m/s: 8 cm.
TEST(PassiveSafety, WhoIsOutOfSightMayComeBackFromWhereHeIs) {
  const NavigatorParams params;
  const PassiveSafety safety(params.robot, params.drive, params.people);
  const double corner_m = params.robot.body.footprint().turning_radius_m();
  for (const double w : {0.5, 1.0}) {
    for (const double direction : {-1.0, 1.0}) {
      const double needed_m =
          0.5 * params.robot.body.length_m + 0.25 + params.people.margin_m + 0.3 +
          1.5 * (params.drive.reaction_s +
                 (corner_m * w - 0.05) / params.robot.braking.deceleration_mps2);
      const auto is_safe = [&](double distance_m, bool is_in_sight) {
        return safety.is_safe(
            {0.0, w}, {{{-distance_m, 0.0}, {1.5 * direction, 0.0}, 0.25, 0.3, 0.0, is_in_sight}});
      };
      // The corners reach farther than half the length, by the body's half diagonal at most.
      EXPECT_TRUE(is_safe(needed_m + 0.15, false)) << w;
      EXPECT_FALSE(is_safe(needed_m - 0.08, false)) << w;
      EXPECT_EQ(is_safe(needed_m - 0.15, true), direction < 0.0) << "in sight he goes on";
    }
  }
}

// He comes from the side at 1 m/s, 1.2 m away. A robot that drives at 1 m/s is out of his way when
// he is there, with 1.1 m ahead of his disc of 0.25 m; braking, it would stand in it.
TEST(PassiveSafety, ItEscapesWhoWouldWalkIntoTheStandingRobot) {
  const NavigatorParams params;
  const PassiveSafety safety(params.robot, params.drive, params.people);
  const People crossing{{{0.3, 1.2}, {0.0, -1.0}, 0.25, 0.0, 0.0}};
  EXPECT_TRUE(safety.escapes({1.0, 0.0}, {1.0, 0.0}, crossing));
  EXPECT_FALSE(safety.escapes({1.0, 0.0}, {0.0, 0.0}, crossing)) << "that is standing";
  // With an error of 0.6 m/s he might be faster. At 1.5 m/s it is too late to be stationary: it
  // goes on where he most likely is not. At 0.3 m/s it is not.
  People uncertain = crossing;
  uncertain[0].velocity_sigma_mps = 0.6;
  ASSERT_FALSE(safety.is_safe({1.5, 0.0}, uncertain));
  EXPECT_TRUE(safety.escapes({1.5, 0.0}, {1.5, 0.0}, uncertain));
  ASSERT_TRUE(safety.is_safe({0.3, 0.0}, uncertain));
  EXPECT_FALSE(safety.escapes({0.3, 0.0}, {1.5, 0.0}, uncertain));
  // Standing is enough: he passes ahead.
  const People ahead{{{1.2, 1.2}, {0.0, -1.0}, 0.25, 0.0, 0.0}};
  EXPECT_FALSE(safety.escapes({0.3, 0.0}, {1.0, 0.0}, ahead));
  // Nor is there any way out between two.
  People both = crossing;
  both.push_back({{2.0, 0.0}, {-1.0, 0.0}, 0.25, 0.0, 0.0});
  EXPECT_FALSE(safety.escapes({1.0, 0.0}, {1.0, 0.0}, both));
}

TEST(PassiveSafety, WhereSomebodyWalksTheRobotDoesNotBackUp) {
  const NavigatorParams params;
  const PassiveSafety safety(params.robot, params.drive, params.people);
  EXPECT_EQ(safety.safe_factor({-0.15, 0.0}, {}), 1.0);
  EXPECT_EQ(safety.safe_factor({-0.15, 0.0}, {{{4.0, 0.0}, {0.0, 1.0}, 0.25, 0.0, 0.0}}), 0.0);
}

// Whatever is near, a slower motion is no less safe.
TEST(PassiveSafety, WhatIsSafeIsSafeMoreSlowlyHeadOn) {
  const NavigatorParams params;
  const PassiveSafety safety(params.robot, params.drive, params.people);
  double last = 0.0;
  for (double distance_m = 0.5; distance_m < 4.0; distance_m += 0.1) {
    const double factor =
        safety.safe_factor({1.0, 0.0}, {{{distance_m, 0.1}, {-1.5, 0.0}, 0.25, 0.05, 0.3}});
    EXPECT_GE(factor, last);
    last = factor;
  }
  EXPECT_EQ(last, 1.0);
}

}  // namespace passive_safety_test
}  // namespace nodmap::navigator
