// SPDX-License-Identifier: BSD-3-Clause
// How the global planner uses the 2D map.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "modules/navigator/local_map/test/scanned_ground.hpp"
#include "modules/navigator/planner/global_planner.hpp"
#include "modules/navigator/planner/map_2d.hpp"

namespace nodmap::navigator {
namespace plan_on_map_test {

using test::Ground;

const robot::Footprint kBody = robot::Body{}.footprint();
const Ground kOpenFloor;
constexpr double kCellM = PlanWindow::kCellM;

// A 2D map of free ground, 20 m x 20 m, with walls.
class DrawnMap {
 public:
  DrawnMap() : cells_(std::size_t{kSize} * kSize, 0) {}

  // Draws a wall between two corners, in metres.
  DrawnMap& wall(const Eigen::Vector2d& min, const Eigen::Vector2d& max) {
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const Eigen::Vector2d p =
            kCellM * (Eigen::Vector2d(x, y) - Eigen::Vector2d::Constant(0.5 * kSize - 0.5));
        if ((p.array() > min.array()).all() && (p.array() < max.array()).all()) {
          cells_[static_cast<std::size_t>(kSize * y + x)] = 100;
        }
      }
    }
    return *this;
  }
  // A square of walls around a place, `half_m` to each side.
  DrawnMap& room(const Eigen::Vector2d& p, double half_m) {
    for (const double side : {-half_m, half_m}) {
      wall(p + Eigen::Vector2d(side - 0.1, -half_m - 0.1),
           p + Eigen::Vector2d(side + 0.1, half_m + 0.1));
      wall(p + Eigen::Vector2d(-half_m - 0.1, side - 0.1),
           p + Eigen::Vector2d(half_m + 0.1, side + 0.1));
    }
    return *this;
  }
  [[nodiscard]] Map2d map() const {
    Map2d map;
    EXPECT_TRUE(map.add({kCellM, {-kSize / 2, -kSize / 2}, kSize, kSize, cells_}));
    return map;
  }

 private:
  static constexpr int kSize = 400;
  std::vector<std::int8_t> cells_;
};

LocalMap look(const Ground& ground) {
  LocalMap map({}, {});
  test::look_around(map, ground);
  return map;
}

// Plans from the origin for five seconds; null for `map`: there is none.
void plan(GlobalPlanner& planner, const LocalMap& local_map, const Map2d* map,
          const Eigen::Vector2d& goal, time::Timestamp start = {}) {
  for (int i = 0; i < 400; ++i) {
    Situation now;
    now.stamp = start + 13'320us * i;
    now.local_map = &local_map;
    now.map_2d = map;
    now.goal = GoalInBase{goal, 0.2};
    planner.step(now);
  }
}

double cost_m(const LocalMap& local_map, const Map2d* map, const Eigen::Vector2d& goal,
              const PlannerParams& params = {}) {
  GlobalPlanner planner(kBody, params);
  plan(planner, local_map, map, goal);
  return planner.cost_to_go()->least_near({0.0, 0.0});
}

TEST(PlanOnMap, WhatOnlyTheMapShowsAsFreeHasAPriceOfItsOwn) {
  PlannerParams params;
  params.unknown_price = 2.0;
  params.map_price = 0.5;
  const Map2d map = DrawnMap().map();
  for (const Map2d* known : {&map, static_cast<const Map2d*>(nullptr)}) {
    GlobalPlanner planner(kBody, params);
    plan(planner, LocalMap({}, {}), known, {6.0, 0.0});
    const double price = known != nullptr ? 1.5 : 3.0;
    // Distances on the grid are exact along an axis, up to a bucket (2 cm) in all and half a cell
    // at each end; 0.14 m lie within the goal's tolerance.
    EXPECT_NEAR(planner.cost_to_go()->at({0.0, 0.0}), price * (6.0 - 0.14) + 0.14, 0.05 * price);
  }
}

TEST(PlanOnMap, LeadsAroundAWallThatOnlyTheMapShows) {
  const Map2d map = DrawnMap().wall({6.0, -6.0}, {6.2, 3.0}).map();
  GlobalPlanner planner(kBody, {});
  plan(planner, LocalMap({}, {}), &map, {8.0, 0.0});
  double highest_m = 0.0;
  for (const Eigen::Vector2d& p : planner.cost_to_go()->path_from({0.0, 0.0}, 40.0)) {
    highest_m = std::max(highest_m, p.y());
    EXPECT_FALSE(p.x() > 5.9 && p.x() < 6.3 && p.y() < 3.0 + kBody.half_width_m) << p.transpose();
  }
  EXPECT_GT(highest_m, 3.0 + kBody.half_width_m);
}

// The map shows a wall ahead where the laser sees floor, as where somebody was standing while it
// was drawn.
TEST(PlanOnMap, WallsDoNotCountWhereTheLocalMapHasShownTheFloor) {
  const LocalMap floor = look(kOpenFloor);
  const Map2d empty = DrawnMap().map();
  const Map2d wall = DrawnMap().wall({1.5, -1.0}, {1.7, 1.0}).map();
  EXPECT_EQ(cost_m(floor, &wall, {3.0, 0.0}), cost_m(floor, &empty, {3.0, 0.0}));
}

// Such as glass, or a box that is lower than the level scans.
TEST(PlanOnMap, WhatTheLocalMapHasShownBlocksWhereTheMapIsFree) {
  const Map2d map = DrawnMap().map();
  EXPECT_FALSE(std::isfinite(cost_m(look(test::fence()), &map, {3.0, 0.0})));
}

// A door that was closed when the map was drawn, and is too far away to see that it is open now.
TEST(PlanOnMap, AGoalThatTheMapShutsInCanBeReachedAllTheSame) {
  const Map2d map = DrawnMap().room({8.0, 0.0}, 1.0).map();
  const LocalMap floor = look(kOpenFloor);
  EXPECT_EQ(cost_m(floor, &map, {8.0, 0.0}), cost_m(floor, nullptr, {8.0, 0.0}));
  const Map2d goal_in_wall = DrawnMap().wall({7.0, -1.0}, {9.0, 1.0}).map();
  EXPECT_TRUE(std::isfinite(cost_m(floor, &goal_in_wall, {8.0, 0.0})));
}

TEST(PlanOnMap, AMapWithoutTilesChangesNothing) {
  const Map2d map;
  for (const Ground& ground : {kOpenFloor, test::fence(), test::fence(0.45)}) {
    const LocalMap seen = look(ground);
    EXPECT_EQ(cost_m(seen, &map, {3.0, 0.0}), cost_m(seen, nullptr, {3.0, 0.0}));
  }
}

// 2D SLAM closes a loop or is restarted: from the next plan on only the new map counts.
TEST(PlanOnMap, ANewMapReplacesTheOldOneWhileAPlanIsMade) {
  const LocalMap nothing({}, {});
  Map2d map = DrawnMap().wall({4.0, -9.0}, {4.2, 9.0}).map();
  GlobalPlanner planner(kBody, {});
  Situation now;
  now.local_map = &nothing;
  now.map_2d = &map;
  now.goal = GoalInBase{{8.0, 0.0}, 0.2};
  planner.step(now);
  map.clear();
  planner.step(now);
  const Map2d empty = DrawnMap().map();
  map = empty;
  plan(planner, nothing, &map, {8.0, 0.0}, time::Timestamp(10s));
  EXPECT_EQ(planner.cost_to_go()->least_near({0.0, 0.0}), cost_m(nothing, &empty, {8.0, 0.0}));
}

}  // namespace plan_on_map_test
}  // namespace nodmap::navigator
