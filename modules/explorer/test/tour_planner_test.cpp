// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/tour_planner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace nodmap::explorer {
namespace tour_planner_test {

constexpr int kMapCells = 320;  // 16 m x 16 m, cells of 5 cm

// A free corridor along x from 2 m to 14 m, 2 m wide, open at both ends: unknown ground to the left
// and to the right.
PlanningGrid corridor() {
  std::vector<std::int8_t> cells(kMapCells * kMapCells, -1);
  for (int y = 138; y < 182; ++y) {
    for (int x = 40; x < 280; ++x) {
      const bool is_wall = y < 140 || y >= 180;
      cells[static_cast<std::size_t>(y * kMapCells + x)] = is_wall ? 100 : 0;
    }
  }
  PlanningGrid grid(0.2);
  EXPECT_TRUE(grid.add({0.05, {0, 0}, kMapCells, kMapCells, cells}));
  return grid;
}

class TourPlannerTest : public ::testing::Test {
 protected:
  // Plans from a place on the corridor's axis, looking along it.
  std::vector<Viewpoint> plan_from(double x_m, TourRequest request) {
    request.T_map_base = {x_m, 8.0, 0.0};
    request.home_map = {8.0, 8.0};
    paths_.compute(grid_, request.T_map_base.translation());
    return dut_.plan({grid_, paths_}, request);
  }

  ExplorerParams params_;
  PlanningGrid grid_ = corridor();
  ShortestPaths paths_;
  TourPlanner dut_{params_};
};

TEST_F(TourPlannerTest, VisitsBothEndsTheNearerOneFirst) {
  for (const double x_m : {6.0, 10.0}) {
    const std::vector<Viewpoint> tour = plan_from(x_m, {});
    ASSERT_GE(tour.size(), 2U);
    EXPECT_EQ(tour.front().p_map.x() < 8.0, x_m < 8.0);
    EXPECT_NE(tour.front().p_map.x() < 8.0, tour.back().p_map.x() < 8.0);
  }
  EXPECT_FALSE(dut_.frontier_cells().empty());
}

TEST_F(TourPlannerTest, KeepsThePresentViewpointUnlessAnotherTourIsClearlyBetter) {
  const auto at_end = [&](bool is_left) {
    const std::vector<Viewpoint> tour = plan_from(8.0, {});
    return std::ranges::find_if(tour,
                                [&](const Viewpoint& v) { return (v.p_map.x() < 8.0) == is_left; })
        ->p_map;
  };
  const Eigen::Vector2d left = at_end(true);
  const Eigen::Vector2d right = at_end(false);
  // In the middle both tours cost nearly the same.
  EXPECT_EQ(plan_from(8.0, {.target_map = left}).front().p_map, left);
  EXPECT_EQ(plan_from(8.0, {.target_map = right}).front().p_map, right);
  // Near one end, turning back for the other one costs far more than tour.hysteresis_ratio.
  EXPECT_NE(plan_from(12.0, {.target_map = left}).front().p_map, left);
}

TEST_F(TourPlannerTest, LeavesOutPlacesAndWhatShowsTooLittle) {
  const std::vector<Viewpoint> right_only =
      plan_from(8.0, {.is_left_out = [](const Eigen::Vector2d& p) { return p.x() < 8.0; }});
  ASSERT_FALSE(right_only.empty());
  EXPECT_TRUE(
      std::ranges::all_of(right_only, [](const Viewpoint& v) { return v.p_map.x() > 8.0; }));
  EXPECT_TRUE(plan_from(8.0, {.is_left_out = [](const Eigen::Vector2d&) { return true; }}).empty());
  EXPECT_TRUE(plan_from(8.0, {.min_gain_m2 = 1e3}).empty());
}

TEST_F(TourPlannerTest, NearestFrontierIsOneViewpointAndStaysUntilTheRobotIsThere) {
  params_.policy = Policy::kNearestFrontier;
  dut_ = TourPlanner(params_);
  const std::vector<Viewpoint> left = plan_from(6.0, {});
  ASSERT_EQ(left.size(), 1U);
  EXPECT_LT(left.front().p_map.x(), 8.0);
  const std::vector<Viewpoint> kept = plan_from(10.0, {.target_map = left.front().p_map});
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept.front().p_map, left.front().p_map);
}

}  // namespace tour_planner_test
}  // namespace nodmap::explorer
