// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/cost_to_go.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <vector>

namespace nodmap::navigator {
namespace cost_to_go_test {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kToleranceM = 0.2;
constexpr double kOutsidePrice = 2.0;

// A window of 3 m x 2 m with random prices; a third of the cells is blocked.
struct Prices {
  explicit Prices(std::uint64_t seed) {
    std::mt19937_64 engine(seed);
    std::uniform_real_distribution<float> any(1.0F, CostSearch::kHighestPrice);
    std::uniform_int_distribution<int> third(0, 2);
    window.origin = {-1.0, -0.5};
    window.width = 60;
    window.height = 40;
    for (std::size_t i = 0; i < window.num_cells(); ++i) {
      price.push_back(third(engine) == 0 ? -1.0F : any(engine));
    }
  }
  [[nodiscard]] double at(int column, int row) const {
    return static_cast<double>(price[window.index_of(column, row)]);
  }
  [[nodiscard]] Eigen::Vector2d middle(int column, int row) const {
    return window.origin + PlanWindow::kCellM * Eigen::Vector2d(column + 0.5, row + 0.5);
  }
  PlanWindow window;
  std::vector<float> price;
};

// Oracle: Bellman-Ford. Starts from these costs and relaxes all edges until nothing changes.
std::vector<double> relax(const Prices& prices, std::vector<double> cost) {
  const PlanWindow& window = prices.window;
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (int row = 0; row < window.height; ++row) {
      for (int column = 0; column < window.width; ++column) {
        for (int i = 0; i < 9; ++i) {
          const int dx = i % 3 - 1;
          const int dy = i / 3 - 1;
          if (!window.contains(column + dx, row + dy) || prices.at(column, row) < 0.0) {
            continue;
          }
          const double total = cost[window.index_of(column + dx, row + dy)] +
                               0.05 * std::hypot(dx, dy) * prices.at(column, row);
          double& here = cost[window.index_of(column, row)];
          if (total < here - 1e-12) {
            here = total;
            has_changed = true;
          }
        }
      }
    }
  }
  return cost;
}

CostToGo search(const Prices& prices, const Eigen::Vector2d& goal_map, int portion) {
  CostSearch dut;
  dut.begin(prices.window, prices.price, goal_map, kToleranceM, kOutsidePrice);
  while (dut.advance(prices.price, portion)) {
  }
  return dut.found();
}

// Tolerance: at each step the search may keep a cost that is 0.1 mm too high, and it rounds costs
// to 1e-6 of their value.
void expect_costs(const CostToGo& found, const std::vector<double>& expected,
                  const Prices& prices) {
  constexpr double kStepErrorM = 1e-4;
  constexpr int kMaxSteps = 300;
  int num_reached = 0;
  for (int row = 0; row < prices.window.height; ++row) {
    for (int column = 0; column < prices.window.width; ++column) {
      const double cost = found.at(prices.middle(column, row));
      const double truth = expected[prices.window.index_of(column, row)];
      ASSERT_EQ(std::isfinite(cost), std::isfinite(truth)) << column << " " << row;
      if (std::isfinite(truth)) {
        ++num_reached;
        EXPECT_GE(cost, truth * (1.0 - 1e-5));
        EXPECT_LE(cost, truth + kStepErrorM * kMaxSteps) << column << " " << row;
      }
    }
  }
  EXPECT_GT(num_reached, 300);
}

TEST(CostSearch, CostsEqualThoseOfBruteForce) {
  for (std::uint64_t seed = 1000; seed < 1006; ++seed) {
    const Prices prices(seed);
    const Eigen::Vector2d goal_map(0.3, 0.4);
    std::vector<double> seeds(prices.window.num_cells(), kNever);
    const double radius_m = 0.7 * kToleranceM;
    for (double dy = -radius_m; dy <= radius_m; dy += 0.05) {
      for (double dx = -radius_m; dx <= radius_m; dx += 0.05) {
        const Eigen::Vector2i cell = prices.window.cell_of(goal_map + Eigen::Vector2d(dx, dy));
        if (dx * dx + dy * dy <= radius_m * radius_m && prices.at(cell.x(), cell.y()) >= 0.0) {
          // Seeds are not at the centres of cells: a later one of the same cell replaces an earlier
          // one.
          seeds[prices.window.index_of(cell.x(), cell.y())] = std::hypot(dx, dy);
        }
      }
    }
    expect_costs(search(prices, goal_map, 1 << 20), relax(prices, seeds), prices);
  }
}

// The ends of onward paths are the cells 0.4 to 0.6 m from the robot. An end costs more the farther
// it is from straight ahead, and the nearer it is.
TEST(CostSearch, OnwardPathsEndInTheCellsBetweenTwoDistances) {
  for (std::uint64_t seed = 1000; seed < 1006; ++seed) {
    const Prices prices(seed);
    const geometry::SE2 T_map_base{prices.middle(15, 15).x(), prices.middle(15, 15).y(), 0.7};
    std::vector<double> seeds(prices.window.num_cells(), kNever);
    for (int row = 0; row < prices.window.height; ++row) {
      for (int column = 0; column < prices.window.width; ++column) {
        const Eigen::Vector2d p = T_map_base.inverse() * prices.middle(column, row);
        if (p.norm() >= 0.4 && p.norm() <= 0.6 && prices.at(column, row) >= 0.0) {
          seeds[prices.window.index_of(column, row)] =
              0.8 * std::abs(std::atan2(p.y(), p.x())) + 3.0 * (0.6 - p.norm());
        }
      }
    }
    CostSearch dut;
    dut.begin_onward(prices.window, prices.price, {T_map_base, 0.4, 0.6, 3.0, 0.8});
    while (dut.advance(prices.price, 100)) {
    }
    expect_costs(dut.found(), relax(prices, seeds), prices);
  }
}

// A cell at the border costs as much as the straight line from it to the goal.
TEST(CostSearch, AGoalOutsideTheWindowIsReachedAcrossItsBorder) {
  for (std::uint64_t seed = 1000; seed < 1006; ++seed) {
    const Prices prices(seed);
    const Eigen::Vector2d goal_map(4.0, 1.0);
    std::vector<double> seeds(prices.window.num_cells(), kNever);
    for (int row = 0; row < prices.window.height; ++row) {
      for (int column = 0; column < prices.window.width; ++column) {
        const bool is_border = row == 0 || column == 0 || row == prices.window.height - 1 ||
                               column == prices.window.width - 1;
        if (is_border && prices.at(column, row) >= 0.0) {
          seeds[prices.window.index_of(column, row)] =
              kOutsidePrice * (goal_map - prices.middle(column, row)).norm();
        }
      }
    }
    expect_costs(search(prices, goal_map, 1 << 20), relax(prices, seeds), prices);
  }
}

// A part of the window, which the paths leave and enter again: beyond it the costs are known from
// the whole.
TEST(CostSearch, InAPartOfTheWindowTheCostsAreThoseOfTheWhole) {
  for (std::uint64_t seed = 1000; seed < 1006; ++seed) {
    const Prices whole(seed);
    Prices part = whole;
    part.window.origin = whole.window.origin + PlanWindow::kCellM * Eigen::Vector2d(20.0, 10.0);
    part.window.width = 30;
    part.window.height = 20;
    part.price.clear();
    for (int row = 0; row < part.window.height; ++row) {
      for (int column = 0; column < part.window.width; ++column) {
        part.price.push_back(whole.price[whole.window.index_of(column + 20, row + 10)]);
      }
    }
    for (const Eigen::Vector2d& goal_map : {Eigen::Vector2d(0.3, 0.4), Eigen::Vector2d(1.7, 1.2)}) {
      const CostToGo beyond = search(whole, goal_map, 1 << 20);
      CostSearch dut;
      dut.begin(part.window, part.price, goal_map, kToleranceM, beyond);
      while (dut.advance(part.price, 100)) {
      }
      std::vector<double> expected;
      for (std::size_t i = 0; i < part.window.num_cells(); ++i) {
        const auto column = static_cast<int>(i % 30);
        const auto row = static_cast<int>(i / 30);
        expected.push_back(beyond.at(part.middle(column, row)));
      }
      expect_costs(dut.found(), expected, part);
    }
  }
}

// A float has steps of 12 cm at such a cost, more than a cell costs.
TEST(CostSearch, CostsAreExactForAGoalAThousandKilometresAway) {
  Prices prices(1000);
  std::ranges::fill(prices.price, static_cast<float>(kOutsidePrice));
  const Eigen::Vector2d goal_map(1e6, 0.4);
  const CostToGo found = search(prices, goal_map, 1 << 20);
  for (int column = 0; column < prices.window.width; ++column) {
    const Eigen::Vector2d p = prices.middle(column, 20);
    // Each step may be 0.1 mm off.
    EXPECT_NEAR(found.at(p), kOutsidePrice * (goal_map.x() - p.x()), 0.01) << column;
  }
  const auto path = found.path_from(prices.middle(0, 20), 100.0);
  EXPECT_GT(path.back().x(), prices.middle(prices.window.width - 2, 20).x());
}

TEST(CostSearch, AThousandKilometresFromTheOriginTheCostsAreTheSame) {
  Prices prices(1000);
  const Eigen::Vector2d goal_map(0.32, 0.42);  // in the middle of a cell, with its window
  const CostToGo near = search(prices, goal_map, 1 << 20);
  const Eigen::Vector2d far_away(1e6, -1e6);
  prices.window.origin += far_away;
  const CostToGo far = search(prices, goal_map + far_away, 1 << 20);
  for (int row = 0; row < prices.window.height; ++row) {
    for (int column = 0; column < prices.window.width; ++column) {
      const Eigen::Vector2d p = prices.middle(column, row);
      if (std::isfinite(far.at(p))) {
        EXPECT_NEAR(far.at(p), near.at(p - far_away), 1e-4);
      } else {
        EXPECT_EQ(far.at(p), near.at(p - far_away));
      }
    }
  }
}

// The work depends on the window, not on the tolerance; every cell is the goal.
TEST(CostSearch, ATolerancePastTheWindowCostsNoMoreThanTheWindow) {
  Prices prices(1000);
  std::ranges::fill(prices.price, 1.0F);
  const Eigen::Vector2d goal_map(0.3, 0.4);
  CostSearch dut;
  dut.begin(prices.window, prices.price, goal_map, 1e6, kOutsidePrice);
  while (dut.advance(prices.price, 1 << 20)) {
  }
  for (int column = 0; column < prices.window.width; ++column) {
    const Eigen::Vector2d p = prices.middle(column, 20);
    // Seeds are not at the centres of cells, but off by up to half of their diagonal.
    EXPECT_NEAR(dut.found().at(p), (p - goal_map).norm(), 0.036) << column;
  }
}

TEST(CostSearch, TheResultDoesNotDependOnTheSizeOfThePortions) {
  const Prices prices(1000);
  const CostToGo at_once = search(prices, {0.3, 0.4}, 1 << 20);
  const CostToGo bit_by_bit = search(prices, {0.3, 0.4}, 7);
  for (int row = 0; row < prices.window.height; ++row) {
    for (int column = 0; column < prices.window.width; ++column) {
      EXPECT_EQ(at_once.at(prices.middle(column, row)), bit_by_bit.at(prices.middle(column, row)));
    }
  }
}

TEST(CostToGo, ThePathGoesDownhillFromCellToCellAndEndsAtTheGoal) {
  const Prices prices(1001);
  const Eigen::Vector2d goal_map(0.3, 0.4);
  const CostToGo cost_to_go = search(prices, goal_map, 1 << 20);
  int num_paths = 0;
  for (int column = 0; column < prices.window.width; column += 5) {
    const Eigen::Vector2d start = prices.middle(column, 35);
    if (!std::isfinite(cost_to_go.at(start))) {
      continue;
    }
    const auto path = cost_to_go.path_from(start, 50.0);
    for (std::size_t i = 1; i < path.size(); ++i) {
      EXPECT_LT(cost_to_go.at(path[i]), cost_to_go.at(path[i - 1]));
      // The length of a diagonal step, with rounding.
      EXPECT_LT((path[i] - path[i - 1]).norm(), 0.0708);
    }
    EXPECT_LT((path.back() - goal_map).norm(), kToleranceM);
    ++num_paths;
  }
  EXPECT_GT(num_paths, 3);
}

TEST(CostToGo, FarOutsideTheWindowThereIsNoPathAndJustOutsideThereIsOne) {
  const Prices prices(1000);
  const CostToGo cost_to_go = search(prices, {0.3, 0.4}, 1 << 20);
  EXPECT_EQ(cost_to_go.at({-1.01, 0.0}), kNever);
  EXPECT_EQ(cost_to_go.at({0.0, 1.51}), kNever);
  EXPECT_EQ(CostToGo().at({0.0, 0.0}), kNever);
  // 0.2 m outside: cells within 0.3 m are considered.
  EXPECT_TRUE(std::isfinite(cost_to_go.least_near({0.0, 1.7})));
  EXPECT_FALSE(std::isfinite(cost_to_go.least_near({0.0, 1.9})));
}

}  // namespace cost_to_go_test
}  // namespace nodmap::navigator
