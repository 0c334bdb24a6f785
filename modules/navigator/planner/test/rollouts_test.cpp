// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/rollouts.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "modules/navigator/local_map/local_map.hpp"
#include "modules/navigator/people/foresight.hpp"
#include "modules/navigator/planner/global_planner.hpp"

namespace nodmap::navigator {
namespace rollouts_test {

const robot::Footprint kBody = robot::Body{}.footprint();

// A plan to a goal 6 m ahead, over unknown ground.
GlobalPlanner planner_to_ahead() {
  const LocalMap map({}, {});
  Situation now;
  now.local_map = &map;
  now.goal = GoalInBase{{6.0, 0.0}, 0.2};
  GlobalPlanner planner(kBody, {});
  for (int i = 0; i < 400 && planner.cost_to_go() == nullptr; ++i) {
    now.stamp = time::Timestamp(13'320us * i);
    planner.step(now);
  }
  return planner;
}

// Walls on both sides of the body.
Points walls(double from_x_m, double clearance_m) {
  Points points;
  for (double x = from_x_m; x < 2.4; x += 0.02) {
    points.emplace_back(x, kBody.half_width_m + clearance_m);
    points.emplace_back(x, -kBody.half_width_m - clearance_m);
  }
  return points;
}

// The walls are 4.75 cm beside the body: too close for fast rollouts, which need 6 cm, but not for
// creeping ones, which need 3 cm. In the open any speed is allowed. The slowest share of a fast
// robot's speed, 15 % of 2 m/s, would be faster than creeping.
TEST(Rollouts, OnlyCreepingRolloutsPassANarrowPlace) {
  const GlobalPlanner planner = planner_to_ahead();
  ASSERT_NE(planner.cost_to_go(), nullptr);
  Rollouts rollouts{NavigatorParams{}};
  for (const double max_forward_mps : {1.0, 2.0}) {
    Situation now;
    const auto fastest_mps = [&] {
      double fastest = 0.0;
      for (const Rollout& rollout : rollouts.plan(now, *planner.cost_to_go(), max_forward_mps)) {
        fastest = std::max(fastest, rollout.forward_mps);
      }
      return fastest;
    };
    EXPECT_EQ(fastest_mps(), max_forward_mps);
    now.points_base = walls(0.3, 0.0475);
    EXPECT_GT(fastest_mps(), 0.0);
    EXPECT_LE(fastest_mps(), DriveParams{}.creep_mps);
  }
}

// From rest, in the 1.6 s of a rollout at 1 m/s, a base that gains 1.5 m/s^2 drives 1.3 m, and one
// that gains 0.2 m/s^2 drives 0.3 m: only the second does not touch a wall 0.6 m ahead.
TEST(Rollouts, ASlowerBaseDrivesLessFar) {
  const GlobalPlanner planner = planner_to_ahead();
  ASSERT_NE(planner.cost_to_go(), nullptr);
  Situation now;
  for (double y = -1.5; y < 1.5; y += 0.02) {
    now.points_base.emplace_back(kBody.half_length_m + 0.6, y);
  }
  for (const double acceleration_mps2 : {1.5, 0.2}) {
    NavigatorParams params;
    params.base.acceleration_mps2 = acceleration_mps2;
    Rollouts rollouts{params};
    const auto& all = rollouts.plan(now, *planner.cost_to_go(), 1.0);
    EXPECT_EQ(std::ranges::any_of(all,
                                  [](const Rollout& rollout) {
                                    return rollout.forward_mps == 1.0 &&
                                           rollout.yaw_rate_rad_s == 0.0;
                                  }),
              acceleration_mps2 == 0.2);
  }
}

// Two posts are 3.1 cm beside the body. Straight on and straight back keep that clearance, wherever
// along the body and in a cell the posts are; so the robot can always leave a place that it could
// reach. A point 5 cm before the body does not forbid backing up.
TEST(Rollouts, StraightOnAndStraightBackArePossibleBetweenTwoNarrowPosts) {
  const GlobalPlanner planner = planner_to_ahead();
  ASSERT_NE(planner.cost_to_go(), nullptr);
  Rollouts rollouts{NavigatorParams{}};
  for (double x = -kBody.half_length_m; x < kBody.half_length_m; x += 0.013) {
    Situation now;
    now.points_base = {{x, kBody.half_width_m + 0.031}, {x, -kBody.half_width_m - 0.031}};
    const auto has_straight = [&](double side) {
      return std::ranges::any_of(
          rollouts.plan(now, *planner.cost_to_go(), 1.5), [&](const Rollout& rollout) {
            return rollout.forward_mps * side > 0.0 && rollout.yaw_rate_rad_s == 0.0 &&
                   rollout.next_yaw_rate_rad_s == 0.0;
          });
    };
    EXPECT_TRUE(has_straight(1.0)) << x;
    EXPECT_TRUE(has_straight(-1.0)) << x;
    now.points_base.emplace_back(kBody.half_length_m + 0.05, 0.0);
    EXPECT_FALSE(has_straight(1.0)) << x;
    EXPECT_TRUE(has_straight(-1.0)) << x;
  }
}

// Without creeping, or without any speed, some of the speeds are 0. To stand still is no way on:
// the planner would take it for ever. It is one only if there are people to give way to.
TEST(Rollouts, OnlyPeopleAreAReasonToStandStill) {
  const GlobalPlanner planner = planner_to_ahead();
  ASSERT_NE(planner.cost_to_go(), nullptr);
  NavigatorParams params;
  params.drive.creep_mps = 0.0;
  Rollouts rollouts{params};
  Situation now;
  const auto may_stand_still = [&](double max_forward_mps) {
    return std::ranges::any_of(rollouts.plan(now, *planner.cost_to_go(), max_forward_mps),
                               [](const Rollout& rollout) {
                                 return rollout.forward_mps == 0.0 && rollout.yaw_rate_rad_s == 0.0;
                               });
  };
  EXPECT_FALSE(may_stand_still(1.0));
  EXPECT_FALSE(may_stand_still(0.0));
  now.people = {{{3.0, 0.0}, {-1.0, 0.0}, 0.25, 0.02, 0.05}};
  EXPECT_TRUE(may_stand_still(1.0));
}

// Smallest distance from the body to a person's centre within 3 s. The robot starts from rest,
// drives the rollout and then goes on or brakes. In steps of 10 ms.
double least_distance_m(const Rollout& rollout, bool goes_on, const Person& person) {
  geometry::SE2 pose;
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
  double least_m = distance_to_body(pose.inverse() * person.position, kBody);
  for (double t = 0.0; t < 3.0; t += 0.01) {
    const bool stops = t >= 1.6 && !goes_on;
    const double to_rad_s = t < 0.8 ? rollout.yaw_rate_rad_s : rollout.next_yaw_rate_rad_s;
    forward_mps += std::clamp((stops ? 0.0 : rollout.forward_mps) - forward_mps, -0.015, 0.015);
    yaw_rate_rad_s += std::clamp((stops ? 0.0 : to_rad_s) - yaw_rate_rad_s, -0.06, 0.06);
    pose = pose * geometry::SE2{0.01 * forward_mps, 0.0, 0.01 * yaw_rate_rad_s};
    least_m = std::min(least_m, distance_to_body(pose.inverse() * person.position_after(t), kBody));
  }
  return least_m;
}

// Something 1 m wide comes straight at the stationary robot at 1 m/s from 3.4 m away: if the robot
// stays, it is hit after 2.7 s. The best rollout is not touched, although the plan leads straight
// ahead.
TEST(Rollouts, TheBestRolloutAvoidsAPersonWhoComesStraightAtTheRobot) {
  const GlobalPlanner planner = planner_to_ahead();
  ASSERT_NE(planner.cost_to_go(), nullptr);
  Rollouts rollouts{NavigatorParams{}};
  Situation now;
  for (const double from_y_m : {-0.2, 0.0, 0.2}) {
    now.people = {{{3.4, from_y_m}, {-1.0, 0.0}, 0.5, 0.02, 0.05}};
    const Rollout& best = rollouts.plan(now, *planner.cost_to_go(), 1.0).front();
    EXPECT_LT(least_distance_m({}, true, now.people[0]), 0.5) << "standing";
    EXPECT_GT(std::max(least_distance_m(best, true, now.people[0]),
                       least_distance_m(best, false, now.people[0])),
              0.5)
        << from_y_m;
  }
}

}  // namespace rollouts_test
}  // namespace nodmap::navigator
