// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/global_planner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "modules/navigator/geofence.hpp"
#include "modules/navigator/local_map/test/scanned_ground.hpp"

namespace nodmap::navigator {
namespace global_planner_test {

using test::Ground;

const robot::Footprint kBody = robot::Body{}.footprint();
constexpr double kToleranceM = 0.2;

// A local map of the ground, seen all around.
LocalMap look(const Ground& ground) {
  LocalMap map({}, {});
  test::look_around(map, ground);
  return map;
}

// A robot on this map, which has this goal.
Situation at(time::Timestamp stamp, const LocalMap& map, const Eigen::Vector2d& goal_map,
             const geometry::SE2& T_odom_base = {}, const geometry::SE2& T_map_odom = {}) {
  Situation now;
  now.stamp = stamp;
  now.T_odom_base = T_odom_base;
  now.T_map_odom = T_map_odom;
  now.local_map = &map;
  now.goal = GoalInBase{now.T_map_base().inverse() * goal_map, kToleranceM};
  return now;
}

// Calls step() until a plan is complete.
void plan(GlobalPlanner& planner, const LocalMap& map, const Eigen::Vector2d& goal) {
  for (int i = 0; i < 400 && planner.cost_to_go() == nullptr; ++i) {
    planner.step(at(time::Timestamp(13'320us * i), map, goal));
  }
}

TEST(GlobalPlanner, OverUnknownGroundTheCostIsTheDistanceTimesThePrice) {
  PlannerParams params;
  params.unknown_price = 1.0;
  GlobalPlanner planner(kBody, params);
  plan(planner, LocalMap({}, {}), {6.0, 0.0});
  ASSERT_NE(planner.cost_to_go(), nullptr);
  // The distance counts up to the border of the goal. Distances on the grid are 8 % too long at
  // worst, and exact along an axis.
  EXPECT_NEAR(planner.cost_to_go()->at({0.0, 0.0}), 2.0 * (6.0 - 0.14) + 0.14, 0.15);
}

// Until there is a plan to the new goal, the robot drives on by the plan to the previous one.
TEST(GlobalPlanner, ThePlanToThePreviousGoalIsKeptUntilThereIsANewOne) {
  GlobalPlanner planner(kBody, {});
  const LocalMap map({}, {});
  const Eigen::Vector2d first(6.0, 0.0);
  const Eigen::Vector2d second(0.0, 6.0);
  EXPECT_EQ(planner.former_cost_to_go(), nullptr);
  plan(planner, map, first);
  EXPECT_EQ(planner.former_cost_to_go(), nullptr);
  const double cost_m = planner.cost_to_go()->at({0.0, 0.0});
  int num_steps = 0;
  do {
    planner.step(at(time::Timestamp(1s + 13'320us * num_steps), map, second));
    if (planner.cost_to_go() == nullptr) {
      ASSERT_NE(planner.former_cost_to_go(), nullptr) << "after " << num_steps;
      EXPECT_EQ(planner.former_cost_to_go()->at({0.0, 0.0}), cost_m);
      EXPECT_LT(planner.former_cost_to_go()->at(first), 0.1);
    }
  } while (planner.cost_to_go() == nullptr && ++num_steps < 400);
  EXPECT_GE(num_steps, 2) << "it is computed in portions";
  ASSERT_NE(planner.cost_to_go(), nullptr);
  EXPECT_LT(planner.cost_to_go()->at(second), 0.1);
  EXPECT_EQ(planner.former_cost_to_go(), nullptr);
  planner.step(at(time::Timestamp(20s), map, first));
  EXPECT_EQ(planner.cost_to_go(), nullptr);
  EXPECT_EQ(planner.former_cost_to_go(), nullptr) << "it is old";
}

// A goal that follows somebody moves on before a plan to it is complete.
TEST(GlobalPlanner, WhileTheGoalMovesThePlanLeadsToWhereItWasAMomentAgo) {
  GlobalPlanner planner(kBody, {});
  const LocalMap map({}, {});
  constexpr double kRadiusM = 8.0;
  std::vector<Eigen::Vector2d> goals;
  for (int i = 0; i < 750; ++i) {  // 10 s
    const double angle_rad = 0.6 * kToleranceM / kRadiusM * (i / 2);
    goals.emplace_back(kRadiusM * std::cos(angle_rad), kRadiusM * std::sin(angle_rad));
    planner.step(at(time::Timestamp(13'320us * i), map, goals.back()));
    if (i < 75) {
      continue;
    }
    const CostToGo* plan =
        planner.cost_to_go() != nullptr ? planner.cost_to_go() : planner.former_cost_to_go();
    ASSERT_NE(plan, nullptr) << "step " << i;
    const bool is_recent = std::any_of(goals.end() - 75, goals.end(),
                                       [&](const auto& goal) { return plan->at(goal) < 0.1; });
    ASSERT_TRUE(is_recent) << "step " << i;
  }
}

TEST(GlobalPlanner, LeadsAroundAWallAndKeepsOffIt) {
  const Ground ground{{{{1.5, -1.2}, {1.6, 3.0}, 0.5}}};
  GlobalPlanner planner(kBody, {});
  plan(planner, look(ground), {3.0, 0.0});
  ASSERT_NE(planner.cost_to_go(), nullptr);
  const auto path = planner.cost_to_go()->path_from({0.0, 0.0}, 20.0);
  EXPECT_LT((path.back() - Eigen::Vector2d(3.0, 0.0)).norm(), kToleranceM);
  for (const Eigen::Vector2d& p : path) {
    const Eigen::Vector2d nearest = p.cwiseMax(ground.blocks[0].min).cwiseMin(ground.blocks[0].max);
    // A cell counts as occupied even if the obstacle is in its farthest corner, 3.5 cm away.
    EXPECT_GT((p - nearest).norm(), kBody.half_width_m + PlannerParams{}.min_clearance_m - 0.035);
  }
}

TEST(GlobalPlanner, PlansTowardsAGoalBeyondTheGrid) {
  GlobalPlanner planner(kBody, {});
  const Eigen::Vector2d goal(80.0, 30.0);
  plan(planner, LocalMap({}, {}), goal);
  ASSERT_NE(planner.cost_to_go(), nullptr);
  const double price = 1.0 + PlannerParams{}.unknown_price;
  // The distance times the price of unknown ground; distances on the grid are 8.2 % too long at
  // worst, and the path crosses the window's border somewhere in a cell of 10 cm.
  EXPECT_NEAR(planner.cost_to_go()->at({0.0, 0.0}), price * goal.norm(),
              price * (0.082 * goal.norm() + 0.1));
  const auto path = planner.cost_to_go()->path_from({0.0, 0.0}, 100.0);
  EXPECT_LT((goal - path.back()).norm(), goal.norm() - 20.0) << "up to the border, 25 m away";
}

TEST(GlobalPlanner, NoGoalCanBeReachedThroughAClosedFence) {
  for (const double goal_m : {3.0, 80.0}) {
    GlobalPlanner planner(kBody, {});
    plan(planner, look(test::fence()), {goal_m, 0.0});
    ASSERT_NE(planner.cost_to_go(), nullptr);
    EXPECT_FALSE(std::isfinite(planner.cost_to_go()->least_near({0.0, 0.0})));
  }
}

TEST(GlobalPlanner, LeadsAroundAHoleInTheGeofenceAndNeverOutOfTheGeofence) {
  const Geofence fence("POLYGON((-2 -3, 6 -3, 6 3, -2 3), (1 -1, 2 -1, 2 2, 1 2))");
  const LocalMap map({}, {});
  const auto plan_within = [&](const Eigen::Vector2d& goal) {
    GlobalPlanner planner(kBody, {});
    for (int i = 0; i < 400 && planner.cost_to_go() == nullptr; ++i) {
      Situation now = at(time::Timestamp(13'320us * i), map, goal);
      now.geofence = &fence;
      planner.step(now);
    }
    return *planner.cost_to_go();
  };
  const auto path = plan_within({3.0, 0.0}).path_from({0.0, 0.0}, 20.0);
  EXPECT_LT((path.back() - Eigen::Vector2d(3.0, 0.0)).norm(), kToleranceM);
  for (const Eigen::Vector2d& p : path) {
    const Eigen::Vector2d nearest =
        p.cwiseMax(Eigen::Vector2d(1, -1)).cwiseMin(Eigen::Vector2d(2, 2));
    // A cell counts as occupied even if the obstacle is in its farthest corner, 3.5 cm away.
    EXPECT_GT((p - nearest).norm(), kBody.half_width_m + PlannerParams{}.min_clearance_m - 0.035);
  }
  EXPECT_FALSE(std::isfinite(plan_within({8.0, 0.0}).least_near({0.0, 0.0})));
}

// Rotates on the spot without measuring anything, until the local map has forgotten all obstacles.
void rotate_blindly(LocalMap& map) {
  scan::Scan scan = test::scan_of({}, {}, 0.0);
  std::ranges::fill(scan.ranges_m, std::numeric_limits<float>::quiet_NaN());
  for (int degree = 0; degree <= 720; degree += 45) {
    map.add_scan(scan, {0.0, 0.0, geometry::deg_to_rad(degree)});
  }
}

// Plans again while the robot looks to all four sides, from `start_s` on.
void plan_looking_around(GlobalPlanner& planner, const LocalMap& map, const Eigen::Vector2d& goal,
                         std::int64_t start_s) {
  for (int i = 0; i < 400; ++i) {
    const geometry::SE2 T_odom_base{0.0, 0.0, 0.5 * geometry::kPi * (i / 100)};
    planner.step(at(time::Timestamp(start_s * 1s + 13'320us * i), map, goal, T_odom_base));
  }
}

// Odometry drifts, so the local map forgets what is not measured again; the pose in map does not
// drift.
TEST(GlobalPlanner, KeepsWallsThatTheLocalMapHasForgottenUntilTheyAreSeenToBeGone) {
  const Eigen::Vector2d goal(3.0, 0.0);
  LocalMap map = look(test::fence());
  GlobalPlanner planner(kBody, {});
  plan(planner, map, goal);
  rotate_blindly(map);
  ASSERT_TRUE(map.points_base({}, 3.0).empty());
  plan_looking_around(planner, map, goal, 10);
  EXPECT_FALSE(std::isfinite(planner.cost_to_go()->least_near({0.0, 0.0})));
  // A planner that never saw the walls does not know about them.
  GlobalPlanner other(kBody, {});
  plan(other, map, goal);
  EXPECT_TRUE(std::isfinite(other.cost_to_go()->least_near({0.0, 0.0})));
  // Now the fence is gone, and the laser sees that.
  for (int i = 0; i < 3; ++i) {
    for (double deg = -60.0; deg <= 0.0; deg += 0.5) {
      map.add_scan(test::scan_of({}, {}, geometry::deg_to_rad(deg)), {});
    }
  }
  plan_looking_around(planner, map, goal, 20);
  EXPECT_TRUE(std::isfinite(planner.cost_to_go()->least_near({0.0, 0.0})));
}

// 2D SLAM corrects the heading of odometry by 20 degrees. A wall behind the robot stays where it
// was when it was seen, until the robot looks at it again: then it is a quarter of a metre farther
// away.
TEST(GlobalPlanner, AWallOutOfViewStaysInPlaceWhenThePoseIsCorrected) {
  const Ground wall{{{{-1.3, -2.0}, {-1.2, 2.0}, 0.5}}};
  const Eigen::Vector2d on_wall(-1.25, 0.6);
  const Eigen::Vector2d goal(-4.0, 0.0);
  LocalMap map = look(wall);
  for (double deg = -60.0; deg <= -10.0; deg += 1.0) {
    const geometry::SE2 T_odom_base{0.0, 0.0, geometry::kPi};
    map.add_scan(test::scan_of(wall, T_odom_base, geometry::deg_to_rad(deg)), T_odom_base);
  }
  GlobalPlanner planner(kBody, {});
  plan_looking_around(planner, map, goal, 0);
  EXPECT_FALSE(std::isfinite(planner.cost_to_go()->at(on_wall)));
  const geometry::SE2 T_map_odom{0.0, 0.0, geometry::deg_to_rad(20.0)};
  for (const double yaw_rad : {0.0, geometry::kPi}) {
    const geometry::SE2 T_odom_base = T_map_odom.inverse() * geometry::SE2{0.0, 0.0, yaw_rad};
    const time::Timestamp start(yaw_rad == 0.0 ? 10s : 20s);
    for (int i = 0; i < 100; ++i) {
      planner.step(at(start + 13'320us * i, map, goal, T_odom_base, T_map_odom));
    }
    EXPECT_EQ(std::isfinite(planner.cost_to_go()->at(on_wall)), yaw_rad != 0.0);
  }
}

// The body is 33 cm wide: it fits through 55 cm with its clearance, and through 36 cm with none.
// From afar such a narrow gap may be free, so it counts as a path until the robot has tried it in
// vain.
TEST(GlobalPlanner, ANarrowGapIsAPathUntilTheRobotHasFailedToPassIt) {
  for (const double gap_m : {0.36, 0.45, 0.55}) {
    const LocalMap map = look(test::fence(gap_m));
    for (const double yaw_rad : {0.0, 0.3, 0.7}) {  // between cells and walls
      const geometry::SE2 T_map_odom{0.01, 0.02, yaw_rad};
      const Eigen::Vector2d goal = T_map_odom * Eigen::Vector2d(3.0, 0.0);
      GlobalPlanner planner(kBody, {});
      for (int i = 0; i < 400; ++i) {
        planner.step(at(time::Timestamp(13'320us * i), map, goal, {}, T_map_odom));
      }
      ASSERT_NE(planner.cost_to_go(), nullptr);
      EXPECT_TRUE(std::isfinite(planner.cost_to_go()->at(T_map_odom.translation()))) << gap_m;
      if (gap_m < 0.4) {
        planner.add_failure(T_map_odom * Eigen::Vector2d(1.05, 0.0));
        for (int i = 0; i < 400; ++i) {
          planner.step(at(time::Timestamp(10s + 13'320us * i), map, goal, {}, T_map_odom));
        }
        EXPECT_FALSE(std::isfinite(planner.cost_to_go()->least_near(T_map_odom.translation())));
      }
    }
  }
}

// The oldest failure is forgotten, so that a robot that is shut in for days does not slow down.
TEST(GlobalPlanner, RemembersTheLastFiftyFailures) {
  GlobalPlanner planner(kBody, {});
  const LocalMap map({}, {});
  int num_seconds = 0;
  const auto cost_m = [&] {
    num_seconds += 10;
    for (int i = 0; i < 100; ++i) {
      planner.step(at(time::Timestamp(num_seconds * 1s + 13'320us * i), map, {3.0, 0.0}));
    }
    return planner.cost_to_go()->at({1.5, 0.0});
  };
  const double before_m = cost_m();
  planner.add_failure({1.5, 0.0});
  for (int i = 0; i < 49; ++i) {
    planner.add_failure({100.0, 0.0});
  }
  EXPECT_GT(cost_m(), before_m + 0.3);
  planner.add_failure({100.0, 0.0});
  EXPECT_EQ(cost_m(), before_m);
}

// 0.3 m is six cells, although 0.3 / 0.05 is rounded to less than 6.
TEST(GlobalPlanner, APlaceWithinThirtyCentimetresOfAFailureCostsMore) {
  GlobalPlanner planner(kBody, {});
  const LocalMap map({}, {});
  int num_seconds = 0;
  const auto cost_m = [&](const Eigen::Vector2d& p_map) {
    num_seconds += 10;
    for (int i = 0; i < 100; ++i) {
      planner.step(at(time::Timestamp(num_seconds * 1s + 13'320us * i), map, {3.0, 0.0}));
    }
    return planner.cost_to_go()->at(p_map);
  };
  const Eigen::Vector2d sixth(1.525, 0.025);
  const Eigen::Vector2d seventh(1.525, -0.025);
  const double sixth_m = cost_m(sixth);
  const double seventh_m = cost_m(seventh);
  planner.add_failure({1.525, 0.325});
  EXPECT_NEAR(cost_m(sixth), sixth_m + 0.05 * PlannerParams{}.failure_price, 1e-3);
  EXPECT_NEAR(cost_m(seventh), seventh_m, 1e-3);
}

// As where map is in the coordinates of a country.
TEST(GlobalPlanner, AThousandKilometresFromTheOriginThePlanIsTheSame) {
  const LocalMap map = look(test::fence(0.55));
  const auto path_from = [&map](const geometry::SE2& T_map_odom) {
    const Eigen::Vector2d goal = T_map_odom * Eigen::Vector2d(3.0, 0.5);
    GlobalPlanner planner(kBody, {});
    for (int i = 0; i < 400; ++i) {
      planner.step(at(time::Timestamp(13'320us * i), map, goal, {}, T_map_odom));
    }
    return planner.cost_to_go()->path_from(T_map_odom.translation(), 20.0);
  };
  const auto near = path_from({0.02, 0.02, 0.3});
  const Eigen::Vector2d far_away(1e6, -1e6);
  const auto far = path_from({far_away.x() + 0.02, far_away.y() + 0.02, 0.3});
  ASSERT_EQ(far.size(), near.size());
  ASSERT_GT(near.size(), 50U);
  for (std::size_t i = 0; i < near.size(); ++i) {
    // Rounding may choose the neighbouring cell.
    EXPECT_LT((far[i] - far_away - near[i]).norm(), 1.5 * PlanWindow::kCellM) << i;
  }
}

TEST(GlobalPlanner, AfterFailuresOnOneSideOfAWallThePathLeadsAroundTheOtherSide) {
  const Ground ground{{{{1.5, -0.9}, {1.6, 1.0}, 0.5}}};
  const LocalMap map = look(ground);
  GlobalPlanner planner(kBody, {});
  plan(planner, map, {3.0, 0.0});
  ASSERT_NE(planner.cost_to_go(), nullptr);
  const auto first = planner.cost_to_go()->path_from({0.0, 0.0}, 20.0);
  const auto lowest = [](const std::vector<Eigen::Vector2d>& path) {
    return std::ranges::min(path, {}, [](const auto& p) { return p.y(); }).y();
  };
  ASSERT_LT(lowest(first), -0.9);
  for (const double y : {-1.2, -1.5, -1.8, -2.1}) {
    planner.add_failure({1.55, y});
  }
  for (int i = 0; i < 400; ++i) {
    planner.step(at(time::Timestamp(10s + 13'320us * i), map, {3.0, 0.0}));
  }
  EXPECT_GT(lowest(planner.cost_to_go()->path_from({0.0, 0.0}, 20.0)), -0.5);
}

}  // namespace global_planner_test
}  // namespace nodmap::navigator
