// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/sweep_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/robot/stopping.hpp"
#include "modules/pitch_controller/speed_bound.hpp"
#include "tests/support/commanded_sweeps.hpp"

namespace nodmap::pitch_controller {
namespace sweep_plan_test {

using geometry::deg_to_rad;
using geometry::rad_to_deg;

constexpr double kStepMps = 0.01;
constexpr double kScanS = 0.01332;
const PitchControllerParams kParams;

SweepPlanner default_planner() {
  return {kParams.robot, kParams.detection, kParams.speed.fast_mps};
}

// The navigator's tests of low sills nod with these. Their last digit is a tenth of a degree, and a
// hundredth for the lines.
TEST(SweepPlan, IsWhatTestsOfOtherModulesNodWith) {
  const SweepPlanner planner = default_planner();
  for (const nodmap::test::CommandedSweep& expected : nodmap::test::kCommandedSweeps) {
    const SweepPlan plan = planner.plan(expected.forward_mps);
    EXPECT_NEAR(rad_to_deg(plan.sweep.min_rad), expected.low_deg, 0.05) << expected.forward_mps;
    EXPECT_NEAR(rad_to_deg(plan.sweep.max_rad), expected.high_deg, 0.05) << expected.forward_mps;
    EXPECT_NEAR(rad_to_deg(plan.line_spacing_rad), expected.line_deg, 0.005);
  }
}

TEST(SweepPlan, TheSpacingIsThatOfTheReferenceTable) {
  // 0.10 m at 1 m from 0.38 m: 2.5 degrees (rounded).
  EXPECT_NEAR(rad_to_deg(line_spacing_rad(0.10, 2, 1.0, 0.38)), 2.5, 0.05);
}

TEST(SweepPlan, WithThisSpacingEnoughLinesHitTheObstacle) {
  // Brute force: whatever the phase of the lines, at least two hit an obstacle above the floor.
  const double dp = line_spacing_rad(0.05, 2, 1.2, 0.38);
  for (double phase = 0.0; phase < 1.0; phase += 0.01) {
    int lines = 0;
    for (int i = -1; (i + phase) * dp > -1.5; --i) {
      const double height = 0.38 + 1.2 * std::tan((i + phase) * dp);
      lines += height >= 0.05 && height <= 0.10 ? 1 : 0;
    }
    EXPECT_GE(lines, 2) << phase;
  }
}

TEST(SweepPlan, CoversTheWholeRangeWhileStationaryAndTheCorridorAtSpeed) {
  const SweepPlanner planner = default_planner();
  const SweepPlan stationary = planner.plan(0.0);
  // To the finest step of the scanner, 0.25 degrees.
  EXPECT_NEAR(rad_to_deg(stationary.area.range_rad()), 120.0, 0.25);
  EXPECT_NEAR(rad_to_deg(stationary.sweep.range_rad()), 120.0, 0.25);
  const VirtualCorridor corridor = VirtualCorridor::of(kParams.robot);
  for (const double v : {1.0, 1.5, 2.0}) {
    const SweepPlan fast = planner.plan(v);
    const PitchInterval least = corridor.area_from(fast.d_min_m);
    EXPECT_NEAR(fast.area.min_rad, least.min_rad, 1e-9);
    EXPECT_NEAR(fast.area.max_rad, least.max_rad, 1e-9);
  }
}

TEST(SweepPlan, ItsNodTakesAsLongAsItsSweep) {
  const SweepPlanner planner = default_planner();
  for (double v = 0.0; v < 4.0; v += 0.1) {
    const SweepPlan plan = planner.plan(v);
    EXPECT_NEAR(plan.nod.ends.range_rad() / plan.nod.rate_rad_s + plan.nod.reversal_s, plan.sweep_s,
                1e-9)  // rounding, of a small difference of squares
        << v;
  }
}

TEST(SweepPlan, ChangesMonotonicallyWithTheSpeed) {
  const SweepPlanner planner = default_planner();
  SweepPlan before = planner.plan(0.0);
  for (double v = kStepMps; v < 4.0; v += kStepMps) {
    const SweepPlan now = planner.plan(v);
    EXPECT_GE(now.area.min_rad, before.area.min_rad) << v;
    EXPECT_LE(now.area.max_rad, before.area.max_rad) << v;
    EXPECT_GE(now.d_min_m, before.d_min_m) << v;
    before = now;
  }
}

// An obstacle that appears two sweeps of driving and the stopping distance ahead is hit again at
// d_min or farther: the laser passes what is ahead within less than two sweeps.
TEST(SweepPlan, AnObstacleBeyondTheRequiredDistanceIsHitBeforeDMin) {
  const SweepPlanner planner = default_planner();
  const VirtualCorridor corridor = VirtualCorridor::of(kParams.robot);
  for (double v = 0.0; v < 4.0; v += kStepMps) {
    const SweepPlan plan = planner.plan(v);
    const double appears_m =
        kParams.robot.braking.required_distance_m(v, kParams.detection.reaction_s(plan.sweep_s));
    const double hit_m = appears_m - v * revisit_s(corridor, plan.nod, appears_m, v);
    EXPECT_LE(plan.d_min_m, hit_m + 1e-9) << v;
  }
}

TEST(SweepPlan, ExtendsOneLineBeyondTheAreaWithinTheHeadsLimits) {
  const SweepPlanner planner = default_planner();
  for (double v = 0.0; v < 4.0; v += kStepMps) {
    const SweepPlan plan = planner.plan(v);
    EXPECT_GE(plan.sweep.min_rad, kParams.robot.head.pitch_min_rad);
    EXPECT_LE(plan.sweep.max_rad, kParams.robot.head.pitch_max_rad);
    if (plan.sweep.min_rad > kParams.robot.head.pitch_min_rad && v <= 1.2) {
      EXPECT_NEAR(plan.area.min_rad - plan.sweep.min_rad, plan.line_spacing_rad, 1e-12);
    }
    if (plan.sweep.max_rad < kParams.robot.head.pitch_max_rad) {
      EXPECT_NEAR(plan.sweep.max_rad - plan.area.max_rad, plan.line_spacing_rad, 1e-12);
    }
  }
}

// Brute force: the longest distance between neighbouring places where scan lines of this nod meet
// the floor, of those that are still far enough ahead for an emergency stop. `servo` multiplies
// the head's rate, and so changes how the lines of upward and downward sweeps lie to each other.
double longest_gap_on_floor_m(const SweepPlan& plan, double forward_mps, double servo) {
  constexpr double kNavigatorReactionS = 0.1;
  const VirtualCorridor corridor = VirtualCorridor::of(kParams.robot);
  const double from_m = corridor.from_axis_m(robot::stopping_distance(
      forward_mps, kNavigatorReactionS, kParams.robot.braking.emergency_deceleration_mps2));
  const double sweep_s = plan.sweep_s / servo;
  std::vector<double> places_m;
  for (double t = 0.0; t < 40.0; t += kScanS) {
    // The reversals take no time here: the rate is constant.
    const double phase = std::fmod(t / sweep_s, 2.0);
    const double pitch_rad =
        plan.sweep.min_rad + plan.sweep.range_rad() * (phase < 1.0 ? phase : 2.0 - phase);
    const double ahead_m = corridor.axis_height_m / std::tan(std::max(1e-3, -pitch_rad));
    if (ahead_m >= from_m) {
      places_m.push_back(forward_mps * t + ahead_m);
    }
  }
  std::ranges::sort(places_m);
  double longest_m = 0.0;
  for (std::size_t i = 1; i < places_m.size(); ++i) {
    // The first and last sweeps have no neighbours.
    const bool is_inside = places_m[i - 1] > forward_mps * 5.0 && places_m[i] < forward_mps * 35.0;
    longest_m = is_inside ? std::max(longest_m, places_m[i] - places_m[i - 1]) : longest_m;
  }
  return longest_m;
}

// Floor cells of the navigator's local map are 2.5 cm long, and more than 15 cm without one is
// unknown ground, before which the robot brakes: lines 17.5 cm apart never leave that much, lines
// 19 cm apart in three of five cases.
TEST(SweepPlan, ScanLinesMeetTheFloorDenselyUpToTheDefaultSpeed) {
  const SweepPlanner planner = default_planner();
  for (double v = 0.3; v <= 1.5 + 1e-9; v += 0.1) {
    for (double servo = 0.97; servo <= 1.03; servo += 0.001) {
      EXPECT_LT(longest_gap_on_floor_m(planner.plan(v), v, servo), 0.19) << v << " " << servo;
    }
  }
}

TEST(SweepPlan, Has15To500ScansPerSweepWithinTheHeadsLimits) {
  const SweepPlanner planner = default_planner();
  for (double v = 0.0; v < 4.0; v += kStepMps) {
    const SweepPlan plan = planner.plan(v);
    EXPECT_GE(plan.sweep_s, 15.0 * kScanS - 1e-12);
    EXPECT_LE(plan.sweep_s, 500.0 * kScanS + 1e-12);
    EXPECT_LE(plan.fastest_s, plan.sweep_s + 1e-12);
    EXPECT_GE(plan.slowest_s, plan.fastest_s);
    EXPECT_LE(plan.line_spacing_rad, kParams.robot.head.pitch_rate_rad_s * kScanS + 1e-12);
  }
}

TEST(SweepPlan, IsTheShortestSweepWithThisSpacingAndHead) {
  const SweepPlanner planner = default_planner();
  for (double v = 0.0; v < 2.0; v += 0.1) {
    const SweepPlan plan = planner.plan(v);
    // Brute force over all rates of the head that keep the spacing.
    double shortest_s = 1e9;
    for (double w = 0.01; w <= kParams.robot.head.pitch_rate_rad_s; w += 0.001) {
      if (w * kScanS <= plan.line_spacing_rad) {
        shortest_s = std::min(shortest_s, plan.sweep.range_rad() / w +
                                              w / kParams.robot.head.pitch_acceleration_rad_s2);
      }
    }
    shortest_s = std::max(shortest_s, 15.0 * kScanS);
    // The search has steps of 0.001 rad/s, which is 0.1 % of 1 rad/s; twice that.
    EXPECT_NEAR(plan.sweep_s, shortest_s, 2e-3 * shortest_s) << v;
  }
}

TEST(SweepPlan, ASweepForASpeedAllowsAHigherSpeed) {
  // So speed and nod never block each other, and the speed does not oscillate at the top speed.
  const SweepPlanner planner = default_planner();
  const VirtualCorridor corridor = VirtualCorridor::of(kParams.robot);
  for (double v = 0.0; v <= kParams.speed.top_mps; v += kStepMps) {
    const SweepPlan plan = planner.plan(v);
    const ClearView view =
        clear_view(corridor, plan.sweep, plan.line_spacing_rad,
                   kParams.detection.visible_obstacle_m, kParams.detection.look_ahead_m);
    EXPECT_GT(speed_bound({view, plan.nod}, {}, corridor, kParams.robot.braking, kParams.detection),
              v + 0.1)
        << v;
    EXPECT_LE(view.near_m, plan.d_min_m + 0.05) << v;
  }
}

// Where the robot cannot use what is far ahead, fewer lines still hit the smallest obstacle from
// d_min to beyond where it is protected, and the bound is above the speed, so speed and nod do not
// block each other.
TEST(SweepPlan, AShortViewMakesShorterSweepsThatStillReachTheProtectedDistance) {
  const SweepPlanner planner = default_planner();
  const VirtualCorridor corridor = VirtualCorridor::of(kParams.robot);
  for (double v = 0.0; v <= kParams.speed.top_mps; v += kStepMps) {
    const SweepPlan open = planner.plan(v);
    for (const double used_m : {0.0, 1.0, 2.0}) {
      const SweepPlan plan = planner.plan(v, v, {.used_m = used_m});
      EXPECT_LE(plan.sweep_s, open.sweep_s + 1e-9) << v;
      EXPECT_LE(corridor.covered_from_m(plan.area), plan.d_min_m + 1e-9) << v;
      const ClearView view =
          clear_view(corridor, plan.sweep, plan.line_spacing_rad,
                     kParams.detection.visible_obstacle_m, kParams.detection.look_ahead_m);
      const double protected_m =
          kParams.robot.braking.required_distance_m(v, kParams.detection.reaction_s(open.sweep_s));
      EXPECT_GE(view.far_m, protected_m) << v << " " << used_m;
      EXPECT_LE(view.near_m, plan.d_min_m + 0.05) << v;
      EXPECT_GT(
          speed_bound({view, plan.nod}, {}, corridor, kParams.robot.braking, kParams.detection),
          v + 0.05)
          << v << " " << used_m;
    }
  }
}

TEST(SweepPlan, GroundThatWasNotSeenMovesTheLowerEndOnly) {
  const SweepPlanner planner = default_planner();
  const VirtualCorridor corridor = VirtualCorridor::of(kParams.robot);
  for (const double v : {0.3, 0.7, 1.0, 1.5}) {
    const SweepPlan plan = planner.plan(v);
    for (const double from_m : {0.0, 0.2, 0.5, 1.0, 5.0}) {
      const SweepPlan down = planner.plan(v, v, {.floor_from_m = from_m});
      const double floor_rad = -std::atan(corridor.axis_height_m / corridor.from_axis_m(from_m));
      EXPECT_NEAR(
          down.sweep.min_rad,
          std::max(kParams.robot.head.pitch().min_rad, std::min(plan.sweep.min_rad, floor_rad)),
          0.01)  // of the iteration: a longer sweep needs lines to look farther ahead
          << v << " " << from_m;
      EXPECT_GE(down.sweep.max_rad, plan.area.max_rad);
      EXPECT_LE(down.line_spacing_rad, plan.line_spacing_rad + 1e-12);
    }
  }
}

// A robot that was faster a moment ago looks around less far. The corridor beyond d_min is covered
// as before, by lines no farther apart and in a shorter time, so the permitted speed is not lower.
TEST(SweepPlan, ANarrowerSweepCoversTheCorridorInAShorterTime) {
  const SweepPlanner planner = default_planner();
  const VirtualCorridor corridor = VirtualCorridor::of(kParams.robot);
  const auto bound_of = [&](const SweepPlan& plan) {
    const ClearView view =
        clear_view(corridor, plan.sweep, plan.line_spacing_rad,
                   kParams.detection.visible_obstacle_m, kParams.detection.look_ahead_m);
    return speed_bound({view, plan.nod}, {}, corridor, kParams.robot.braking, kParams.detection);
  };
  for (double v = 0.0; v < 1.5; v += 0.05) {
    for (double looking_mps = v; looking_mps < 1.5; looking_mps += 0.1) {
      const SweepPlan wide = planner.plan(v);
      const SweepPlan narrow = planner.plan(v, looking_mps, {});
      EXPECT_EQ(narrow.d_min_m, wide.d_min_m);
      EXPECT_LE(corridor.covered_from_m(narrow.area), narrow.d_min_m + 1e-9) << v;
      EXPECT_LE(narrow.sweep_s, wide.sweep_s + 1e-9) << v;
      EXPECT_GE(bound_of(narrow), bound_of(wide) - 0.02) << v << " " << looking_mps;
    }
  }
}

}  // namespace sweep_plan_test
}  // namespace nodmap::pitch_controller
