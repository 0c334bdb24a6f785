// SPDX-License-Identifier: BSD-3-Clause
// Goals, and paths, that lead out of the global planner's window.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "modules/navigator/local_map/test/scanned_ground.hpp"
#include "modules/navigator/planner/global_planner.hpp"
#include "modules/navigator/planner/known_ground.hpp"
#include "modules/navigator/planner/map_2d.hpp"

namespace nodmap::navigator {
namespace far_goal_test {

const robot::Footprint kBody = robot::Body{}.footprint();
constexpr double kCellM = PlanWindow::kCellM;
constexpr double kNever = std::numeric_limits<double>::infinity();

struct Rectangle {
  Eigen::Vector2d min;
  Eigen::Vector2d max;

  [[nodiscard]] double distance_m(const Eigen::Vector2d& p) const {
    return (p - p.cwiseMax(min).cwiseMin(max)).norm();
  }
};

// Corridors 2.4 m wide between walls, as a 2D map shows them; everything else is unknown. The map
// reaches from x = -5 m, y = -5 m to 105 m, 30 m.
class Building {
 public:
  // The corridors' middle lines run along the axes.
  explicit Building(const std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>>& lines)
      : cells_(std::size_t{kWidth} * kHeight, -1) {
    const Eigen::Vector2d half = Eigen::Vector2d::Constant(1.2);
    for (const auto& [a, b] : lines) {
      corridors_.push_back({a.cwiseMin(b) - half, a.cwiseMax(b) + half});
    }
    for (int row = 0; row < kHeight; ++row) {
      for (int column = 0; column < kWidth; ++column) {
        const double beside_m = outside_m(middle(column, row));
        if (beside_m < 0.15) {
          cells_[index(column, row)] = beside_m > 0.0 ? 100 : 0;
        }
      }
    }
  }

  [[nodiscard]] Map2d map() const {
    constexpr int kTile = 200;
    Map2d map;
    for (int row = 0; row < kHeight; row += kTile) {
      for (int column = 0; column < kWidth; column += kTile) {
        std::vector<std::int8_t> tile;
        for (int i = 0; i < kTile * kTile; ++i) {
          const int x = column + i % kTile;
          const int y = row + i / kTile;
          tile.push_back(x < kWidth && y < kHeight ? cells_[index(x, y)] : std::int8_t{-1});
        }
        EXPECT_TRUE(map.add({kCellM, {column - kZero, row - kZero}, kTile, kTile, tile}));
      }
    }
    return map;
  }

  // Oracle: the length of the shortest path of the robot's centre from each cell, by Dijkstra's
  // algorithm over the whole grid.
  [[nodiscard]] double path_m(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
    using Entry = std::pair<double, std::size_t>;
    std::vector<double> length_m(cells_.size(), kNever);
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    queue.emplace(0.0, index_of(to));
    length_m[index_of(to)] = 0.0;
    while (!queue.empty()) {
      const auto [length, cell] = queue.top();
      queue.pop();
      if (length > length_m[cell]) {
        continue;
      }
      const auto column = static_cast<int>(cell % kWidth);
      const auto row = static_cast<int>(cell / kWidth);
      for (int i = 0; i < 9; ++i) {
        const int x = column + i % 3 - 1;
        const int y = row + i / 3 - 1;
        const double total = length + kCellM * std::hypot(x - column, y - row);
        if (x >= 0 && y >= 0 && x < kWidth && y < kHeight && is_passable(x, y) &&
            total < length_m[index(x, y)] - 1e-9) {
          length_m[index(x, y)] = total;
          queue.emplace(total, index(x, y));
        }
      }
    }
    return length_m[index_of(from)];
  }

 private:
  static constexpr int kWidth = 2200;
  static constexpr int kHeight = 700;
  static constexpr int kZero = 100;  // row and column of map 0, 0

  static std::size_t index(int column, int row) {
    return static_cast<std::size_t>(row) * kWidth + static_cast<std::size_t>(column);
  }
  static std::size_t index_of(const Eigen::Vector2d& p) {
    return index(static_cast<int>(std::floor(p.x() / kCellM)) + kZero,
                 static_cast<int>(std::floor(p.y() / kCellM)) + kZero);
  }
  static Eigen::Vector2d middle(int column, int row) {
    return kCellM * Eigen::Vector2d(column - kZero + 0.5, row - kZero + 0.5);
  }
  // Distance from the nearest corridor; 0 inside.
  [[nodiscard]] double outside_m(const Eigen::Vector2d& p) const {
    double least_m = kNever;
    for (const Rectangle& corridor : corridors_) {
      least_m = std::min(least_m, corridor.distance_m(p));
    }
    return least_m;
  }
  // The middle of the body, on the axes and the diagonals, is in a corridor.
  [[nodiscard]] bool is_passable(int column, int row) const {
    const Eigen::Vector2d p = middle(column, row);
    const double r = kBody.half_width_m;
    for (const Eigen::Vector2d& side :
         {Eigen::Vector2d(r, 0.0), Eigen::Vector2d(-r, 0.0), Eigen::Vector2d(0.0, r),
          Eigen::Vector2d(0.0, -r), Eigen::Vector2d(0.0, 0.0)}) {
      if (outside_m(p + side) > 0.0) {
        return false;
      }
    }
    return true;
  }

  std::vector<Rectangle> corridors_;
  std::vector<std::int8_t> cells_;
};

// Straight ahead is a dead end, 60 m long; the goal is behind it, 72 m away.
Building dead_end() {
  return Building({{{0.0, 0.0}, {58.8, 0.0}},
                   {{0.0, 0.0}, {0.0, 20.0}},
                   {{0.0, 20.0}, {72.0, 20.0}},
                   {{72.0, 20.0}, {72.0, 0.0}}});
}

// The cost of a metre is 1, but near walls.
PlannerParams flat() {
  PlannerParams params;
  params.nearness_price = 0.0;
  params.map_price = 0.0;
  params.min_clearance_m = 0.0;
  return params;
}

// Plans from the origin until there is a plan.
void plan(GlobalPlanner& planner, const Map2d& map, const Eigen::Vector2d& goal) {
  const LocalMap nothing({}, {});
  for (int i = 0; i < 2000 && planner.cost_to_go() == nullptr; ++i) {
    Situation now;
    now.stamp = time::Timestamp(13'320us * i);
    now.local_map = &nothing;
    now.map_2d = &map;
    now.goal = GoalInBase{goal, 0.2};
    planner.step(now);
  }
  ASSERT_NE(planner.cost_to_go(), nullptr);
}

struct Case {
  const char* name;
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> lines;
  Eigen::Vector2d goal;
};

// Straight ahead 100 m; round a corner after 60 m; a dead end of 60 m in between; a goal that is in
// the window, while the only way there leads out of it.
TEST(FarGoal, TheCostIsThatOfAPlanOverTheWholeMap) {
  const Case cases[] = {
      {"corridor", {{{0.0, 0.0}, {100.0, 0.0}}}, {97.0, 0.0}},
      {"corner", {{{0.0, 0.0}, {60.0, 0.0}}, {{60.0, 0.0}, {60.0, 28.0}}}, {60.0, 25.0}},
      {"way round",
       {{{0.0, 0.0}, {45.0, 0.0}}, {{45.0, 0.0}, {45.0, 8.0}}, {{45.0, 8.0}, {0.0, 8.0}}},
       {0.0, 8.0}},
  };
  for (const Case& c : cases) {
    const Building building(c.lines);
    GlobalPlanner planner(kBody, flat());
    plan(planner, building.map(), c.goal);
    const double truth_m = building.path_m({0.0, 0.0}, c.goal);
    ASSERT_TRUE(std::isfinite(truth_m)) << c.name;
    // The goal's tolerance, the edge of a coarse cell at the window's border and at the goal, and a
    // coarse cell at each bend.
    EXPECT_NEAR(planner.cost_to_go()->least_near({0.0, 0.0}), truth_m, 0.8) << c.name;
  }
}

TEST(FarGoal, TheRobotDoesNotEnterADeadEndThatIsLongerThanTheWindow) {
  const Building building = dead_end();
  GlobalPlanner planner(kBody, flat());
  const Eigen::Vector2d goal(72.0, 0.0);
  plan(planner, building.map(), goal);
  EXPECT_NEAR(planner.cost_to_go()->least_near({0.0, 0.0}), building.path_m({0.0, 0.0}, goal), 0.8);
  for (const Eigen::Vector2d& p : planner.cost_to_go()->path_from({0.0, 0.0}, 15.0)) {
    EXPECT_LT(p.x(), 1.2) << "it goes up";
  }
}

// While all ground is planned for a first goal there is a second one. Straight ahead to it is the
// dead end.
TEST(FarGoal, TheRobotDoesNotSetOffStraightToASecondGoalEither) {
  const Building building = dead_end();
  const Map2d map = building.map();
  const LocalMap nothing({}, {});
  GlobalPlanner planner(kBody, flat());
  Situation now;
  now.local_map = &nothing;
  now.map_2d = &map;
  now.goal = GoalInBase{{72.0, 20.0}, 0.2};
  for (int i = 0; i < 5; ++i, now.stamp += 13'320us) {
    planner.step(now);
  }
  ASSERT_EQ(planner.cost_to_go(), nullptr);
  const Eigen::Vector2d second(72.0, 0.0);
  now.goal = GoalInBase{second, 0.2};
  for (int i = 0; i < 2000 && planner.cost_to_go() == nullptr; ++i, now.stamp += 13'320us) {
    planner.step(now);
  }
  ASSERT_NE(planner.cost_to_go(), nullptr);
  EXPECT_NEAR(planner.cost_to_go()->least_near({0.0, 0.0}), building.path_m({0.0, 0.0}, second),
              0.8);
}

// A goal that moves on before all ground has been planned for it.
TEST(FarGoal, AGoalThatMovesIsApproachedAllTheSame) {
  const LocalMap nothing({}, {});
  GlobalPlanner planner(kBody, {});
  Situation now;
  now.local_map = &nothing;
  for (int i = 0; i < 750; ++i, now.stamp += 13'320us) {  // 10 s
    now.goal = GoalInBase{{80.0, -20.0 + 0.02 * i}, 0.2};
    planner.step(now);
    if (i >= 300) {
      EXPECT_TRUE(planner.cost_to_go() != nullptr || planner.former_cost_to_go() != nullptr) << i;
    }
  }
}

// A decision visits at most a million cells before a search, and searches at most 32 000.
TEST(FarGoal, AllGroundIsPlannedInPortions) {
  GlobalPlanner planner(kBody, {});
  const LocalMap nothing({}, {});
  int num_steps = 0;
  for (; num_steps < 400 && planner.cost_to_go() == nullptr; ++num_steps) {
    Situation now;
    now.stamp = time::Timestamp(13'320us * num_steps);
    now.local_map = &nothing;
    now.goal = GoalInBase{{80.0, 80.0}, 0.2};
    planner.step(now);
  }
  // All ground, 86 m x 86 m with cells of 10 cm, is visited eleven times: 8.1 million cells; the
  // window, 28.6 m x 28.6 m with cells of 5 cm, five times. The first decision begins.
  const int least = 1 + 8 + 740'000 / 32'000 + 2 + 327'000 / 32'000;
  EXPECT_GE(num_steps, least);
  EXPECT_LE(num_steps, least + 4) << "the last portion of each part is a smaller one";
}

TEST(FarGoal, WithoutAnythingBeyondTheWindowThereIsOnlyTheWindow) {
  KnownGround ground;
  const LocalMap nothing({}, {});
  Situation now;
  now.local_map = &nothing;
  ground.update(now);
  EXPECT_FALSE(ground.window_of_all({0.0, 0.0}, {20.0, -20.0}, nullptr));
  const auto all = ground.window_of_all({0.0, 0.0}, {60.0, -40.0}, nullptr);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->cell_m, 0.1);
  // From 3 m beyond the robot to 3 m beyond the goal.
  EXPECT_NEAR(all->origin.x(), -3.0, 0.11);
  EXPECT_NEAR(all->origin.y(), -43.0, 0.11);
  EXPECT_NEAR(all->width * all->cell_m, 66.0, 0.21);
  EXPECT_NEAR(all->height * all->cell_m, 46.0, 0.21);
  const auto greatest = ground.window_of_all({0.0, 0.0}, {9000.0, -9000.0}, nullptr);
  ASSERT_TRUE(greatest);
  EXPECT_LE(greatest->num_cells(), 1'100'000U);
  EXPECT_GE(greatest->width * greatest->cell_m, 100.0) << "as far as the ground is remembered";
}

// The robot drives 60 m away, where it sees nothing of it.
TEST(FarGoal, GroundBeyondTheWindowIsRemembered) {
  KnownGround ground;
  LocalMap map({}, {});
  test::look_around(map, test::fence());
  Situation now;
  now.local_map = &map;
  ground.update(now);
  const auto count_blocked = [&] {
    int count = 0;
    for (int y = -60; y < 60; ++y) {
      for (int x = -60; x < 60; ++x) {
        count += ground.at({x, y}) == KnownGround::Kind::kBlocked ? 1 : 0;
      }
    }
    return count;
  };
  const int at_first = count_blocked();
  EXPECT_GT(at_first, 50);
  const LocalMap nothing({}, {});
  now.local_map = &nothing;
  now.T_odom_base = {60.0, 0.0, 0.0};
  ground.update(now);
  EXPECT_EQ(count_blocked(), at_first);
  ground.forget();
  EXPECT_EQ(count_blocked(), 0);
}

}  // namespace far_goal_test
}  // namespace nodmap::navigator
