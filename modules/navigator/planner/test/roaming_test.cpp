// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/roaming.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "modules/navigator/local_map/test/scanned_ground.hpp"

namespace nodmap::navigator {
namespace roaming_test {

// What the nodding laser sees from one place, looking in this many of the four directions.
LocalMap seen_from_start(const test::Ground& ground, int quarters = 1) {
  LocalMap map({}, {});
  for (int quarter = 0; quarter < quarters; ++quarter) {
    const double yaw_rad = 0.5 * geometry::kPi * (quarter + 1 - quarters);
    test::sweep(map, ground, {0.0, 0.0, yaw_rad}, 1.0);
  }
  return map;
}

time::Timestamp at_scan(int number) {
  return time::Timestamp(13'320us * number);
}

// A robot on this map.
Situation at(time::Timestamp stamp, const LocalMap& map, const geometry::SE2& T_odom_base = {}) {
  Situation now;
  now.stamp = stamp;
  now.T_odom_base = T_odom_base;
  now.local_map = &map;
  return now;
}

CostToGo onward(const test::Ground& ground, int quarters = 1) {
  const LocalMap map = seen_from_start(ground, quarters);
  GlobalPlanner planner(NavigatorParams().robot.body.footprint(), {});
  for (int i = 0; i < 40 && planner.cost_to_go() == nullptr; ++i) {
    planner.step_onward(at(at_scan(i), map));
  }
  EXPECT_NE(planner.cost_to_go(), nullptr);
  return planner.cost_to_go() == nullptr ? CostToGo() : *planner.cost_to_go();
}

// Ahead there is floor that was seen, where a metre costs a metre. The tolerance is for the curve
// of the ring where paths end, and for the distances on the grid.
TEST(PlanOnward, LeadsStraightAheadInTheOpen) {
  const CostToGo cost = onward({});
  EXPECT_NEAR(cost.at({0.5, 0.0}) - cost.at({1.5, 0.0}), 1.0, 0.05);
  EXPECT_GT(cost.at({0.0, 1.0}), cost.at({1.0, 0.0}));
  EXPECT_GT(cost.at({-1.0, 0.0}), cost.at({0.0, 1.0}));
}

// A pocket 1.2 m deep and 0.8 m wide straight ahead.
TEST(PlanOnward, LeadsPastAPocketAndNotIntoIt) {
  const CostToGo cost = onward({{{{1.0, 0.4}, {2.3, 0.5}, 0.5},
                                 {{1.0, -0.5}, {2.3, -0.4}, 0.5},
                                 {{2.2, -0.5}, {2.3, 0.5}, 0.5}}});
  const auto path = cost.path_from({0.3, 0.0}, 5.0);
  EXPECT_NEAR(path.back().norm(), 3.5, 0.1);
  for (const Eigen::Vector2d& p : path) {
    EXPECT_FALSE(p.x() > 1.2 && p.x() < 2.2 && std::abs(p.y()) < 0.4) << p.transpose();
  }
}

// A closed room of 4 m x 3 m: the path ends before the wall, and is finite.
TEST(PlanOnward, InASmallRoomItLeadsToTheFarEnd) {
  const CostToGo cost = onward({{{{-1.0, 1.5}, {3.0, 1.6}, 0.8},
                                 {{-1.0, -1.6}, {3.0, -1.5}, 0.8},
                                 {{3.0, -1.6}, {3.1, 1.6}, 0.8},
                                 {{-1.1, -1.6}, {-1.0, 1.6}, 0.8}}},
                               4);
  ASSERT_TRUE(std::isfinite(cost.at({0.0, 0.0})));
  const auto path = cost.path_from({0.3, 0.0}, 5.0);
  EXPECT_GT(path.back().x(), 1.5);
  EXPECT_LT(path.back().x(), 2.9);
}

// After a goal has led the robot away, a plan made around its former place is of no use.
TEST(PlanOnward, APlanMadeAroundAFormerPlaceIsDropped) {
  const LocalMap map = seen_from_start({});
  GlobalPlanner planner(NavigatorParams().robot.body.footprint(), {});
  for (int i = 0; i < 40; ++i) {
    planner.step_onward(at(at_scan(i), map));
  }
  ASSERT_NE(planner.cost_to_go(), nullptr);
  const geometry::SE2 T_odom_base{2.0, 0.0, 0.0};
  planner.step_onward(at(at_scan(40), map, T_odom_base));
  EXPECT_EQ(planner.cost_to_go(), nullptr);
  for (int i = 41; i < 100; ++i) {
    planner.step_onward(at(at_scan(i), map, T_odom_base));
  }
  EXPECT_NE(planner.cost_to_go(), nullptr);
}

struct RoamingTest : testing::Test {
  // Decides this many times with the robot in one place, though its wheels turn; returns the last
  // decision.
  std::optional<Decision> decide(const test::Ground& ground, double forward_mps, int num_decisions,
                                 int quarters = 1) {
    const LocalMap map = seen_from_start(ground, quarters);
    Situation now;
    now.local_map = &map;
    now.max_forward_mps = max_forward_mps;
    now.points_base = map.points_base({}, 2.5);
    now.forward_mps = forward_mps;
    SeenDirections seen(SteerParams{});
    seen.update(0.0, 0);
    seen.update(0.0, 2);
    now.seen = &seen;
    std::optional<Decision> decision;
    for (int i = 0; i < num_decisions; ++i) {
      now.stamp = at_scan(i);
      decision = roaming.decide(now);
    }
    return decision;
  }

  double max_forward_mps = 1.0;
  Roaming roaming{{}};
};

// A wall is 1.2 m ahead and ends 0.3 m to the left of the robot's middle. The robot drives round it
// on the left at more than half of its speed, and neither stops nor turns on the spot.
TEST_F(RoamingTest, PassesTheEndOfAWallWithoutStopping) {
  const auto decision = decide({{{{1.4, -2.5}, {1.5, 0.3}, 0.5}}}, 0.6, 20);
  ASSERT_TRUE(decision);
  EXPECT_GT(decision->forward_mps, 0.3);
  // The wall's end is 0.3 m aside and 1.4 m ahead: a curvature of 2 * 0.3 / 1.4^2.
  EXPECT_GT(decision->yaw_rate_rad_s, 0.3 * decision->forward_mps);
}

// A lane 0.9 m wide ends 0.4 m before the robot. All headings that a rollout of 1.6 s reaches face
// its walls.
TEST_F(RoamingTest, AtTheEndOfALaneItTurnsRoundAtOnce) {
  const auto decision = decide({{{{-1.5, 0.45}, {0.8, 0.55}, 0.5},
                                 {{-1.5, -0.55}, {0.8, -0.45}, 0.5},
                                 {{0.7, -0.55}, {0.8, 0.55}, 0.5}}},
                               0.0, 40, 4);
  ASSERT_TRUE(decision);
  EXPECT_EQ(decision->forward_mps, 0.0);
  EXPECT_NEAR(std::abs(decision->yaw_rate_rad_s), NavigatorParams().turn.rate_rad_s,
              1e-9);  // rounding
}

TEST_F(RoamingTest, WaitsForItsFirstPlan) {
  const auto decision = decide({}, 0.0, 1);
  ASSERT_TRUE(decision);
  EXPECT_EQ(decision->forward_mps, 0.0);
  EXPECT_EQ(decision->reason.why, Why::kPlans);
}

// In the open the robot drives straight on, slowly. It makes no progress for four seconds, which is
// longer than allowed. Then the path 0.4 m ahead costs more, and after one more plan it bends
// around that place.
TEST_F(RoamingTest, WithoutProgressItTakesAnotherPath) {
  max_forward_mps = 0.2;
  const auto first = decide({}, 0.0, 40);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->yaw_rate_rad_s, 0.0);
  const auto later = decide({}, 0.0, 40 + 300);
  ASSERT_TRUE(later);
  // Half of the body's width aside after 0.4 m: a curvature of 2 * 0.165 / 0.4^2.
  EXPECT_GT(std::abs(later->yaw_rate_rad_s), 2.0 * later->forward_mps)
      << later->forward_mps << " " << to_text(later->reason);
}

}  // namespace roaming_test
}  // namespace nodmap::navigator
