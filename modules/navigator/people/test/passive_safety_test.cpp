// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/passive_safety.hpp"

#include <gtest/gtest.h>

namespace nodmap::navigator {
namespace passive_safety_test {

// The walker comes head on. With reaction time T and deceleration a, the robot is stationary (5
// cm/s) after T + (v - 0.05) / a, and has driven v T + (v^2 - 0.05^2) / 2a by then; the walker has
// walked his speed times that. Tolerance: steps of 50 ms at 2 m/s and more, 0.15 m.
TEST(PassiveSafety, AMotionIsSafeIfTheRobotIsStationaryBeforeAWalkerTouchesIt) {
  const NavigatorParams params;
  const PassiveSafety safety(params);
  const double T = params.drive.reaction_s;
  for (const double v : {0.3, 0.7, 1.2}) {
    for (const double walker_mps : {0.5, 1.4, 2.0}) {
      const auto needed_m = [&](double a) {
        return v * T + (v * v - 0.0025) / (2.0 * a) + walker_mps * (T + (v - 0.05) / a) +
               0.5 * params.robot.body.length_m + 0.25 + params.people.margin_m;
      };
      const auto walker = [&](double distance_m) {
        return People{{{distance_m, 0.0}, {-walker_mps, 0.0}, 0.25, 0.0, 0.0}};
      };
      const double ordinary_m = needed_m(params.robot.braking.deceleration_mps2);
      EXPECT_FALSE(safety.is_safe({v, 0.0}, walker(ordinary_m - 0.15))) << v << ' ' << walker_mps;
      EXPECT_TRUE(safety.is_safe({v, 0.0}, walker(ordinary_m + 0.15))) << v << ' ' << walker_mps;
      const double emergency_m = needed_m(params.robot.braking.emergency_deceleration_mps2);
      EXPECT_FALSE(safety.can_stop({v, 0.0}, walker(emergency_m - 0.15))) << v << ' ' << walker_mps;
      EXPECT_TRUE(safety.can_stop({v, 0.0}, walker(emergency_m + 0.15))) << v << ' ' << walker_mps;
    }
  }
}

TEST(PassiveSafety, StandingIsSafeAndSoIsDrivingBehindAWalkerWhoLeaves) {
  const NavigatorParams params;
  const PassiveSafety safety(params);
  EXPECT_TRUE(safety.is_safe({}, {{{0.3, 0.0}, {-1.0, 0.0}, 0.25, 0.1, 0.3}}));
  EXPECT_EQ(safety.safe_factor({0.8, 0.0}, {{{1.2, 0.0}, {1.5, 0.0}, 0.25, 0.05, 0.2}}), 1.0);
  // He crosses ahead and is gone before the robot gets there.
  EXPECT_EQ(safety.safe_factor({0.5, 0.0}, {{{1.0, 0.6}, {0.0, 1.2}, 0.25, 0.05, 0.2}}), 1.0);
  // The corners of a robot that rotates beside a person count as well.
  const double factor = safety.safe_factor({0.0, 1.0}, {{{0.0, 0.5}, {0.0, -0.8}, 0.2, 0.0, 0.0}});
  EXPECT_LT(factor * params.robot.body.footprint().turning_radius_m(), 0.05);  // stationary
}

// A rotation at w is over after T + (r w - 0.05) / a, where r reaches to the corners. By then
// somebody out of sight may have walked his speed times that, in any direction. Tolerance: steps of
// 50 ms at 1.5 m/s, 8 cm.
TEST(PassiveSafety, SomebodyOutOfSightMayWalkInAnyDirection) {
  const NavigatorParams params;
  const PassiveSafety safety(params);
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
      // The corners reach farther than half the body's length; the tolerance of 0.15 m covers that.
      EXPECT_TRUE(is_safe(needed_m + 0.15, false)) << w;
      EXPECT_FALSE(is_safe(needed_m - 0.08, false)) << w;
      EXPECT_EQ(is_safe(needed_m - 0.15, true), direction < 0.0) << "in sight he walks straight on";
    }
  }
}

// A walker comes from the side at 1 m/s and is 1.2 m away. A robot that drives on at 1 m/s has
// passed before he is there: it is then 1.1 m beyond his disc of 0.25 m. If it braked, it would
// stop in his way.
TEST(PassiveSafety, DrivingOnEscapesAWalkerWhoWouldWalkIntoTheStoppedRobot) {
  const NavigatorParams params;
  const PassiveSafety safety(params);
  const People crossing{{{0.3, 1.2}, {0.0, -1.0}, 0.25, 0.0, 0.0}};
  EXPECT_TRUE(safety.escapes({1.0, 0.0}, {1.0, 0.0}, crossing));
  EXPECT_FALSE(safety.escapes({1.0, 0.0}, {0.0, 0.0}, crossing)) << "to stop is no escape";
  // With an error of 0.6 m/s he might be faster. At 1.8 m/s not even an emergency stop is in time,
  // so the error does not count: it drives on where he most likely is not. At 0.3 m/s it can stop,
  // so the error counts.
  People uncertain = crossing;
  uncertain[0].velocity_sigma_mps = 0.6;
  ASSERT_FALSE(safety.can_stop({1.8, 0.0}, uncertain));
  EXPECT_TRUE(safety.escapes({1.8, 0.0}, {1.8, 0.0}, uncertain));
  ASSERT_TRUE(safety.can_stop({0.3, 0.0}, uncertain));
  EXPECT_FALSE(safety.escapes({0.3, 0.0}, {1.5, 0.0}, uncertain));
  // If the robot stops, he passes ahead of it: there is nothing to escape from.
  const People ahead{{{1.2, 1.2}, {0.0, -1.0}, 0.25, 0.0, 0.0}};
  EXPECT_FALSE(safety.escapes({0.3, 0.0}, {1.0, 0.0}, ahead));
  EXPECT_FALSE(safety.escapes({0.3, 0.0}, {0.3, 0.0}, {{{10.0, 0.0}, {0.0, 1.0}, 0.25}}));
  // Between two walkers there is no escape.
  People both = crossing;
  both.push_back({{2.0, 0.0}, {-1.0, 0.0}, 0.25, 0.0, 0.0});
  EXPECT_FALSE(safety.escapes({1.0, 0.0}, {1.0, 0.0}, both));
}

// A speed that no robot has: it would brake for more than a week.
TEST(PassiveSafety, ARobotThatCannotStopWithinAMinuteIsNotSafe) {
  const NavigatorParams params;
  const PassiveSafety safety(params);
  EXPECT_FALSE(safety.is_safe({1e6, 0.0}, {{{0.0, -100.0}, {0.0, 0.0}, 0.25, 0.0, 0.0}}));
  EXPECT_FALSE(safety.is_safe({0.0, 1e6}, {{{0.0, -100.0}, {0.0, 0.0}, 0.25, 0.0, 0.0}}));
}

TEST(PassiveSafety, DoesNotBackUpWhileAPersonIsTracked) {
  const NavigatorParams params;
  const PassiveSafety safety(params);
  EXPECT_EQ(safety.safe_factor({-0.15, 0.0}, {}), 1.0);
  EXPECT_EQ(safety.safe_factor({-0.15, 0.0}, {{{4.0, 0.0}, {0.0, 1.0}, 0.25, 0.0, 0.0}}), 0.0);
  // Nor is it safe if it does, with somebody behind it.
  EXPECT_FALSE(safety.is_safe({-0.7, 0.0}, {{{-1.0, 0.0}, {1.4, 0.0}, 0.25, 0.0, 0.0}}));
}

// The walker comes head on: the farther away he is, the faster the robot may drive.
TEST(PassiveSafety, TheSafeSpeedGrowsWithTheDistanceOfAWalkerHeadOn) {
  const NavigatorParams params;
  const PassiveSafety safety(params);
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
