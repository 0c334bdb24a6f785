// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/viewpoints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "modules/explorer/frontiers.hpp"

namespace nodmap::explorer {
namespace viewpoints_test {

constexpr int kMapCells = 320;  // 16 m x 16 m, cells of 5 cm
constexpr double kCellArea = 0.01;

// A free room of 8 m x 8 m within unknown ground, with pieces of wall on its border; the gaps
// between them are frontiers.
PlanningGrid half_walled_room(std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::uniform_int_distribution<int> length(4, 30);
  std::vector<std::int8_t> cells(kMapCells * kMapCells, -1);
  const auto at = [&](int x, int y) -> std::int8_t& {
    return cells[static_cast<std::size_t>(y * kMapCells + x)];
  };
  for (int y = 80; y < 240; ++y) {
    for (int x = 80; x < 240; ++x) {
      at(x, y) = 0;
    }
  }
  for (int side = 0; side < 4; ++side) {
    bool is_wall = false;
    for (int from = 80; from < 240; is_wall = !is_wall) {
      const int to = std::min(240, from + length(engine));
      for (; from < to; ++from) {
        if (is_wall) {
          (side == 0   ? at(from, 80)
           : side == 1 ? at(from, 239)
           : side == 2 ? at(80, from)
                       : at(239, from)) = 100;
        }
      }
    }
  }
  PlanningGrid grid(0.2);
  EXPECT_TRUE(grid.add({0.05, {0, 0}, kMapCells, kMapCells, cells}));
  return grid;
}

// The room, the paths from a place in it, and the lookouts.
struct Room {
  explicit Room(std::uint64_t seed) : grid(half_walled_room(seed)) {
    paths.compute(grid, {7.0, 8.5});
    Frontiers frontiers;
    frontiers.find({grid, paths});
    lookouts = frontiers.lookouts({grid, paths}, 2.0);
  }
  [[nodiscard]] Reach reach() const { return {grid, paths}; }

  PlanningGrid grid;
  ShortestPaths paths;
  std::vector<Cell> lookouts;
};

// Oracle: chooses viewpoints one by one, each among all lookouts, by the cells that none of the
// previous ones shows.
TEST(ViewpointChooser, ChoosesTheSameAsBruteForce) {
  constexpr double kYawRad = 0.3;
  std::size_t num_chosen = 0;
  for (std::uint64_t seed = 1000; seed < 1006; ++seed) {
    const Room room(seed);
    ASSERT_GT(room.lookouts.size(), 10U);
    ExplorerParams params;
    params.view.min_gain_m2 = 1.5;
    std::vector<std::vector<std::uint32_t>> shows;  // by lookout
    for (const Cell& lookout : room.lookouts) {
      // The robot may stop before the viewpoint by the tolerance.
      RayCaster caster(params.view, params.robot.mount.x_m - params.goal_tolerance_m);
      shows.push_back(caster.unknown_cells(room.grid, room.grid.center_of(lookout),
                                           room.paths.heading_rad(lookout, kYawRad)));
    }
    for (const int max_viewpoints : {1, 4, 10}) {
      params.tour.max_viewpoints = max_viewpoints;
      const auto chosen = ViewpointChooser(params).choose(room.reach(), room.lookouts, kYawRad);
      std::set<std::uint32_t> shown;
      for (std::size_t i = 0; i <= chosen.size(); ++i) {
        double best_value = 0.0;
        double best_gain_m2 = 0.0;
        std::size_t best = 0;
        for (std::size_t k = 0; k < room.lookouts.size(); ++k) {
          const auto num_new = std::ranges::count_if(
              shows[k], [&](std::uint32_t cell) { return !shown.contains(cell); });
          const double gain_m2 = kCellArea * static_cast<double>(num_new);
          const double value = gain_m2 * std::exp(-params.tour.discount_per_m *
                                                  room.paths.length_m(room.lookouts[k]));
          // Tolerance: rounding only, because gains are whole numbers of cells.
          if (gain_m2 >= params.view.min_gain_m2 - 1e-9 && value > best_value) {
            best_value = value;
            best_gain_m2 = gain_m2;
            best = k;
          }
        }
        if (i == chosen.size()) {
          EXPECT_TRUE(best_value == 0.0 || std::ssize(chosen) == max_viewpoints)
              << "there was another one";
          break;
        }
        EXPECT_EQ(chosen[i].cell, room.lookouts[best]) << "seed " << seed << ", viewpoint " << i;
        EXPECT_NEAR(chosen[i].gain_m2, best_gain_m2, 1e-9);  // rounding
        EXPECT_EQ(chosen[i].length_m, room.paths.length_m(room.lookouts[best]));
        EXPECT_EQ(chosen[i].p_map, room.grid.center_of(room.lookouts[best]));
        shown.insert(shows[best].begin(), shows[best].end());
      }
      num_chosen += chosen.size();
    }
  }
  EXPECT_GT(num_chosen, 30U);
}

// The minimum gain is the median of what the lookouts show in all directions, so half of them show
// enough.
TEST(ViewpointChooser, NearestIsTheFirstLookoutThatShowsEnough) {
  std::ptrdiff_t num_skipped = 0;
  for (std::uint64_t seed = 1000; seed < 1006; ++seed) {
    const Room room(seed);
    ExplorerParams params;
    ViewParams around = params.view;
    around.half_angle_rad = geometry::kPi;
    std::vector<double> gains_m2;
    for (const Cell& lookout : room.lookouts) {
      RayCaster caster(around, 0.0);
      const auto& cells = caster.unknown_cells(room.grid, room.grid.center_of(lookout), 0.0);
      gains_m2.push_back(kCellArea * static_cast<double>(cells.size()));
    }
    std::vector<double> sorted = gains_m2;
    std::ranges::sort(sorted);
    params.view.min_gain_m2 = sorted[sorted.size() / 2] - 0.5 * kCellArea;  // between two gains
    const auto enough = std::ranges::find_if(
        gains_m2, [&](double gain_m2) { return gain_m2 >= params.view.min_gain_m2; });
    const std::ptrdiff_t first = enough - gains_m2.begin();
    const auto nearest = ViewpointChooser(params).nearest(room.reach(), room.lookouts);
    ASSERT_TRUE(nearest);
    EXPECT_EQ(nearest->cell, room.lookouts[static_cast<std::size_t>(first)]);
    EXPECT_NEAR(nearest->gain_m2, *enough, 1e-9);  // rounding
    num_skipped += first;
  }
  EXPECT_GT(num_skipped, 0) << "the first was always enough";
}

// 200 lookouts are rated; 200 more only if these show nothing.
TEST(ViewpointChooser, FartherLookoutsAreRatedOnlyIfTheNearerOnesShowNothing) {
  const Room room(1000);
  ExplorerParams params;
  ViewpointChooser dut(params);
  const auto best = dut.choose(room.reach(), room.lookouts, 0.0);
  ASSERT_FALSE(best.empty());
  const Cell blind = room.grid.cell_of({8.0, 8.0});  // 4 m from the border
  params.view.range_m = 3.0;
  ViewpointChooser short_sighted(params);
  std::vector<Cell> lookouts(250, blind);
  EXPECT_TRUE(short_sighted.choose(room.reach(), lookouts, 0.0).empty());
  lookouts.push_back(best.front().cell);
  const auto found = short_sighted.choose(room.reach(), lookouts, 0.0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().cell, best.front().cell);
  lookouts.insert(lookouts.begin(), room.lookouts.begin(), room.lookouts.end());
  for (const Viewpoint& viewpoint : short_sighted.choose(room.reach(), lookouts, 0.0)) {
    EXPECT_NE(viewpoint.cell, blind);
  }
}

TEST(ViewpointChooser, WithoutLookoutsOrUnknownGroundThereIsNoViewpoint) {
  const Room room(1000);
  ViewpointChooser dut({});
  EXPECT_TRUE(dut.choose(room.reach(), {}, 0.0).empty());
  EXPECT_FALSE(dut.nearest(room.reach(), {}));
  constexpr int kKnownCells = kMapCells + 240;  // 6 m more on each side: the range of the view
  std::vector<std::int8_t> cells(kKnownCells * kKnownCells, 0);
  PlanningGrid known(0.2);
  ASSERT_TRUE(known.add({0.05, {-120, -120}, kKnownCells, kKnownCells, cells}));
  EXPECT_TRUE(dut.choose({known, room.paths}, room.lookouts, 0.0).empty());
  EXPECT_FALSE(dut.nearest({known, room.paths}, room.lookouts));
}

}  // namespace viewpoints_test
}  // namespace nodmap::explorer
