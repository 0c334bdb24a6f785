// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <vector>

#include "modules/navigator/local_map/test/scanned_ground.hpp"
#include "modules/navigator/planner/goal_drive.hpp"
#include "modules/navigator/trail.hpp"

namespace nodmap::navigator {
namespace narrow_place_test {

// A robot on floor that it has seen, 2 m before its goal, between two rows of points. These are
// `beside_m` beside its body, and reach from `from_m` before its rear to half a metre ahead of it.
class BetweenRows {
 public:
  explicit BetweenRows(double beside_m, double from_m = 0.0) {
    test::sweep(map_, {});
    seen_.update(0.0, 0);
    seen_.update(0.0, 2);
    now.local_map = &map_;
    now.seen = &seen_;
    now.max_forward_mps = 1.0;
    now.goal = GoalInBase{{2.0, 0.0}, 0.3};
    const robot::Footprint body = NavigatorParams().robot.body.footprint();
    for (double x = -body.half_length_m + from_m; x < body.half_length_m + 0.5; x += 0.01) {
      for (const double side : {-1.0, 1.0}) {
        now.points_base.emplace_back(x, side * (body.half_width_m + beside_m));
      }
    }
  }
  BetweenRows(const BetweenRows&) = delete;
  BetweenRows& operator=(const BetweenRows&) = delete;

  Situation now;

 private:
  LocalMap map_{{}, {}};
  SeenDirections seen_{SteerParams{}};
};

// What it decides when it has a plan.
Decision last_decision(BetweenRows& rows, const NavigatorParams& params = {}) {
  GoalDrive drive(params);
  Decision decision;
  for (int i = 0; i < 40; ++i) {
    rows.now.stamp = time::Timestamp(time::from_seconds(0.01332 * i));
    decision = drive.decide(rows.now);
  }
  return decision;
}

Decision between_rows(double beside_m) {
  BetweenRows rows(beside_m);
  return last_decision(rows);
}

TEST(NarrowPlace, DrivesMoreSlowlyInANarrowerPlace) {
  const DriveParams params;
  const double creep_m = 0.5 * (params.side_margin_m + params.creep_margin_m);
  const double squeeze_m = 0.5 * (params.creep_margin_m + params.squeeze_margin_m);
  EXPECT_GT(between_rows(params.side_margin_m + 0.01).forward_mps, params.creep_mps);
  const double creeping_mps = between_rows(creep_m).forward_mps;
  EXPECT_GT(creeping_mps, params.squeeze_mps);
  EXPECT_LE(creeping_mps, params.creep_mps);
  const double squeezing_mps = between_rows(squeeze_m).forward_mps;
  EXPECT_GT(squeezing_mps, 0.5 * params.squeeze_mps);
  EXPECT_LE(squeezing_mps, params.squeeze_mps);
  EXPECT_EQ(between_rows(0.5 * params.squeeze_margin_m).forward_mps, 0.0);
}

// The robot has come straight from behind, and the rows begin before its front. It backs up only
// where it cannot squeeze through.
TEST(NarrowPlace, WithALevelLaserItSqueezesThroughInsteadOfBackingUp) {
  const DriveParams params;
  Trail trail(20.0);
  for (double x = -1.0; x <= 0.0; x += 0.03) {
    trail.move({x, 0.0, 0.0});
    trail.record({x, 0.0, 0.0});
  }
  for (const bool can_squeeze : {false, true}) {
    BetweenRows rows(0.5 * (params.creep_margin_m + params.squeeze_margin_m),
                     2.0 * NavigatorParams().robot.body.footprint().half_length_m + 0.01);
    rows.now.trail = &trail;
    rows.now.laser_is_held = true;
    NavigatorParams navigator;
    navigator.drive.squeeze_margin_m =
        can_squeeze ? params.squeeze_margin_m : params.creep_margin_m;
    const Decision decision = last_decision(rows, navigator);
    EXPECT_EQ(decision.reason, Reason(can_squeeze ? Why::kSqueezes : Why::kBacksUp))
        << to_text(decision.reason);
    EXPECT_EQ(decision.forward_mps > 0.0, can_squeeze);
  }
}

// Both walls are 5 mm beside the body, and the robot has not driven here.
TEST(NarrowPlace, ARobotThatCannotMoveSaysSoAfterAWhile) {
  BetweenRows rows(0.005);
  Situation& now = rows.now;
  GoalDrive drive({});
  const auto reason_at = [&](double time_s) {
    Decision decision;
    for (; now.stamp < time::Timestamp(time::from_seconds(time_s)); now.stamp += 100ms) {
      decision = drive.decide(now);
      EXPECT_TRUE(decision.forward_mps == 0.0 || time_s > 25.0);
    }
    return decision.reason;
  };
  const auto num_points_of_path = [&] {
    return drive.path_map({}, {2.0, 0.0, 0.0}).value_or(std::vector<Eigen::Vector2d>()).size();
  };
  EXPECT_EQ(reason_at(11.0), Reason(Why::kNoWayBack));
  EXPECT_GT(num_points_of_path(), 0U);
  EXPECT_EQ(reason_at(25.0), Reason(Why::kCannotMove));
  EXPECT_EQ(num_points_of_path(), 0U);
  now.points_base.clear();
  EXPECT_NE(reason_at(25.5), Reason(Why::kCannotMove));
  EXPECT_GT(num_points_of_path(), 0U);
}

// A motion now and then is a motion: where the robot jerks through, PathProgress says whether it
// gets on. And a new goal is tried anew.
TEST(NarrowPlace, OnlyTimeWithoutAnyMotionCountsAsNotBeingAbleToMove) {
  BetweenRows rows(0.005);
  Situation& now = rows.now;
  const auto rows_base = now.points_base;
  GoalDrive drive({});
  int num_decisions = 0;
  for (; now.stamp < time::Timestamp(25s); now.stamp += 100ms) {
    now.points_base = ++num_decisions % 2 == 0 ? rows_base : std::vector<Eigen::Vector2d>();
    EXPECT_NE(drive.decide(now).reason, Reason(Why::kCannotMove));
  }
  now.points_base = rows_base;
  for (; now.stamp < time::Timestamp(50s); now.stamp += 100ms) {
    (void)drive.decide(now);
  }
  EXPECT_EQ(drive.decide(now).reason, Reason(Why::kCannotMove));
  now.goal = GoalInBase{{1.5, 0.5}, 0.3};
  for (const time::Timestamp until = now.stamp + 5s; now.stamp < until; now.stamp += 100ms) {
    EXPECT_NE(drive.decide(now).reason, Reason(Why::kCannotMove));
  }
}

}  // namespace narrow_place_test
}  // namespace nodmap::navigator
