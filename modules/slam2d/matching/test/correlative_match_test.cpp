// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/matching/correlative_match.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>

namespace nodmap::slam2d {
namespace correlative_match_test {

using geometry::SE2;
using Points = std::vector<Eigen::Vector2d>;

constexpr double kCellM = 0.1;
constexpr SearchLimits kLimits{.min_score = 0.5, .min_peak_ratio = 0.9};

void add_wall(Points& points, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const double length = (to - from).norm();
  for (double at = 0.0; at <= length; at += 0.05) {
    points.emplace_back(from + at / length * (to - from));
  }
}

// A room of 8 m x 6 m with a corner cut off and a pillar: no two corners alike.
Points room() {
  Points points;
  add_wall(points, {-3, -2}, {5, -2});
  add_wall(points, {5, -2}, {5, 4});
  add_wall(points, {5, 4}, {-1, 4});
  add_wall(points, {-1, 4}, {-3, 2});
  add_wall(points, {-3, 2}, {-3, -2});
  add_wall(points, {2, 1}, {2.6, 1.2});
  return points;
}

// Every 7th point of the map, as seen from a pose.
Points seen_from(const SE2& T_map_base, const Points& map) {
  Points seen;
  for (std::size_t i = 0; i < map.size(); i += 7) {
    seen.push_back(T_map_base.inverse() * map[i]);
  }
  return seen;
}

// The best score of all poses in the window.
double exhaustive_score(const LikelihoodGrid& grid, const Points& scan,
                        const SearchWindow& window) {
  const double step_rad = rotation_step_rad(scan, grid.cell_size_m());
  const int rotations = static_cast<int>(std::ceil(window.rotation_rad / step_rad));
  const int steps = static_cast<int>(std::ceil(window.distance_m / grid.cell_size_m()));
  int best = 0;
  for (int rotation = -rotations; rotation <= rotations; ++rotation) {
    const Eigen::Matrix2d R =
        SE2{0.0, 0.0, window.T_target_base.yaw + rotation * step_rad}.rotation();
    for (int x = -steps; x <= steps; ++x) {
      for (int y = -steps; y <= steps; ++y) {
        int sum = 0;
        for (const Eigen::Vector2d& p : scan) {
          const Eigen::Vector2i cell = grid.cell_of(R * p + window.T_target_base.translation());
          sum += grid.largest(0, cell.x() + x, cell.y() + y);
        }
        best = std::max(best, sum);
      }
    }
  }
  return best / (255.0 * static_cast<double>(scan.size()));
}

// The oracle for sums over many windows.
int sum_of_largest(const LikelihoodGrid& grid, int level, std::span<const Eigen::Vector2i> cells,
                   int x, int y) {
  int sum = 0;
  for (const Eigen::Vector2i& cell : cells) {
    sum += grid.largest(level, cell.x() + x, cell.y() + y);
  }
  return sum;
}

TEST(LikelihoodGrid, EachLevelHoldsTheLargestValueOfItsWindow) {
  const LikelihoodGrid grid(room(), kCellM, 50.0);
  for (int level = 1; level < LikelihoodGrid::kLevels; ++level) {
    const int width = 1 << level;
    for (int y = 0; y < 100; y += 7) {
      for (int x = 0; x < 120; x += 5) {
        int largest = 0;
        for (int dy = 0; dy < width; ++dy) {
          for (int dx = 0; dx < width; ++dx) {
            largest = std::max(largest, grid.largest(0, x + dx, y + dy));
          }
        }
        ASSERT_EQ(grid.largest(level, x, y), largest) << level << " " << x << " " << y;
      }
    }
  }
}

// The oracle is an exhaustive search: branch and bound must not miss its best score.
TEST(CorrelativeMatch, FindsTheBestScoreOfAnExhaustiveSearch) {
  const Points map = room();
  const LikelihoodGrid grid(map, kCellM, 50.0);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> metres(-1.2, 1.2);
  std::normal_distribution<double> noise(0.0, 0.05);
  for (int run = 0; run < 10; ++run) {
    const SE2 truth{metres(random), metres(random), metres(random)};
    Points scan = seen_from(truth, map);
    for (Eigen::Vector2d& p : scan) {
      p += Eigen::Vector2d(noise(random), noise(random));
    }
    const SearchWindow window{{truth.x + 0.5 * metres(random), truth.y + 0.5 * metres(random),
                               truth.yaw + 0.2 * metres(random)},
                              1.0,
                              0.3};
    const CorrelativeMatch match =
        match_in_window(grid, scan, window, {.min_score = 0.1, .min_peak_ratio = 0.9});
    ASSERT_FALSE(match.peaks.empty());
    EXPECT_NEAR(match.peaks[0].score, exhaustive_score(grid, scan, window), 1e-12);
  }
}

TEST(CorrelativeMatch, FindsThePoseToWithinACell) {
  const Points map = room();
  const LikelihoodGrid grid(map, kCellM, 50.0);
  const SE2 truth{1.3, 0.4, 2.0};
  const CorrelativeMatch match =
      match_in_window(grid, seen_from(truth, map), {{0.0, 0.0, 0.0}, 3.0, 3.1}, kLimits);
  ASSERT_TRUE(match.is_unique());
  EXPECT_NEAR(match.peaks[0].T_target_base.x, truth.x, kCellM);
  EXPECT_NEAR(match.peaks[0].T_target_base.y, truth.y, kCellM);
  EXPECT_NEAR(match.peaks[0].T_target_base.yaw, truth.yaw, 0.03);  // two steps of rotation
  EXPECT_GT(match.peaks[0].score, 0.8);
}

// An oblong room looks the same when rotated by 180 degrees.
TEST(CorrelativeMatch, ASymmetricRoomIsAmbiguous) {
  Points map;
  add_wall(map, {-4, -3}, {4, -3});
  add_wall(map, {4, -3}, {4, 3});
  add_wall(map, {4, 3}, {-4, 3});
  add_wall(map, {-4, 3}, {-4, -3});
  const LikelihoodGrid grid(map, kCellM, 50.0);
  const CorrelativeMatch match =
      match_in_window(grid, seen_from({0.5, 0.3, 0.2}, map), {{}, 1.0, 3.14}, kLimits);
  ASSERT_EQ(match.peaks.size(), 2U);
  EXPECT_NEAR(std::abs(geometry::angle_difference(match.peaks[0].T_target_base.yaw,
                                                  match.peaks[1].T_target_base.yaw)),
              geometry::kPi, 0.05);  // two steps of rotation
}

TEST(CorrelativeMatch, PlacesAlongACorridorAreAmbiguous) {
  Points map;
  add_wall(map, {-20, -1}, {20, -1});
  add_wall(map, {-20, 1}, {20, 1});
  const LikelihoodGrid grid(map, kCellM, 50.0);
  Points scan;
  add_wall(scan, {-5, -1}, {5, -1});
  add_wall(scan, {-5, 1}, {5, 1});
  const CorrelativeMatch match = match_in_window(grid, scan, {{}, 3.0, 0.3}, kLimits);
  EXPECT_EQ(match.peaks.size(), 2U);
}

TEST(CorrelativeMatch, NothingIsFoundWithoutPointsOrOutsideTheGrid) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto is_found = [&](const LikelihoodGrid& grid, const Points& scan) {
    return !match_in_window(grid, scan, {{}, 1.0, 0.1}, kLimits).peaks.empty();
  };
  EXPECT_FALSE(is_found(LikelihoodGrid({}, kCellM, 50.0), room()));
  const LikelihoodGrid grid(Points{{0.0, 0.0}, {kNan, 1.0}, {1.0, 0.0}}, kCellM, 50.0);
  EXPECT_FALSE(is_found(grid, {}));
  EXPECT_FALSE(is_found(grid, Points{{500.0, 500.0}}));
  EXPECT_FALSE(is_found(grid, Points{{kNan, 1e300}}));
}

// Compares the bounds of the largest windows, which are computed many at a time, with their sums
// computed one by one.
TEST(LikelihoodGrid, BoundsOfManyWindowsAreNoLowerThanTheirSums) {
  const Points map = room();
  const LikelihoodGrid grid(map, kCellM, 50.0);
  std::vector<Eigen::Vector2i> cells;
  for (const Eigen::Vector2d& p : seen_from({0.5, 0.2, 1.0}, map)) {
    cells.push_back(grid.cell_of(p));
  }
  constexpr int kTopCells = LikelihoodGrid::kTopCells;
  for (const int x : {-77, 0, 5}) {
    for (const int y : {-3, 0, 8}) {
      const auto top_cells = grid.top_cells(cells, x, y);
      for (const int column : {-20, -2, 0, 8, 38}) {
        for (const int row : {-11, -1, 0, 8}) {
          const LikelihoodGrid::RowChunk bounds = grid.top_bounds(top_cells, column, row);
          for (int i = 0; i < LikelihoodGrid::kRowChunk; ++i) {
            const int sum = sum_of_largest(grid, LikelihoodGrid::kTopLevel, cells,
                                           x + (column + i) * kTopCells, y + row * kTopCells);
            ASSERT_GE(bounds[static_cast<std::size_t>(i)], sum);
            // A step of 17 for each point that fits.
            ASSERT_LE(bounds[static_cast<std::size_t>(i)],
                      sum + 16 * static_cast<int>(cells.size()));
          }
        }
      }
    }
  }
}

// The oracle: each quarter alone. Shifts include those at which points are partly or wholly outside
// the grid.
TEST(LikelihoodGrid, SumsOfQuartersAreThoseOfEachAlone) {
  const Points map = room();
  const LikelihoodGrid grid(map, kCellM, 50.0);
  std::vector<Eigen::Vector2i> cells;
  for (const Eigen::Vector2d& p : seen_from({0.5, 0.2, 1.0}, map)) {
    cells.push_back(grid.cell_of(p));
  }
  for (int level = 0; level < LikelihoodGrid::kTopLevel; ++level) {
    const int half = 1 << level;
    for (const int x : {-200, -77, -16, 0, 5, 64, 300}) {
      for (const int y : {-90, -3, 0, 8, 71}) {
        const auto sum_at = [&](int dx, int dy) {
          return sum_of_largest(grid, level, cells, x + dx, y + dy);
        };
        const LikelihoodGrid::Quarters expected{sum_at(0, 0), sum_at(0, half), sum_at(half, 0),
                                                sum_at(half, half)};
        ASSERT_EQ(grid.sums_of_quarters(level, cells, x, y, 0), expected);
        // With a minimum, sums below it may be any that are below it.
        const int min_sum = *std::ranges::max_element(expected);
        const LikelihoodGrid::Quarters sums = grid.sums_of_quarters(level, cells, x, y, min_sum);
        for (std::size_t i = 0; i < sums.size(); ++i) {
          ASSERT_EQ(std::max(sums[i], min_sum - 1), std::max(expected[i], min_sum - 1));
        }
      }
    }
  }
}

// The pose is at both ends of the window, half a turn from the guess.
TEST(CorrelativeMatch, APoseHalfATurnFromTheGuessIsUnique) {
  const Points map = room();
  const LikelihoodGrid grid(map, kCellM, 50.0);
  const SE2 truth{0.5, -0.3, geometry::kPi};
  const CorrelativeMatch match =
      match_in_window(grid, seen_from(truth, map), {{}, 2.0, geometry::kPi}, kLimits);
  ASSERT_TRUE(match.is_unique());
  EXPECT_LT(geometry::distance_m(match.peaks[0].T_target_base, truth), 2.0 * kCellM);
}

// In this symmetric room a scan fits two places. Only the one in the left half is allowed.
TEST(LikelihoodGrid, OnlyAllowedPlacesAreFound) {
  Points map;
  add_wall(map, {-4, -3}, {4, -3});
  add_wall(map, {4, -3}, {4, 3});
  add_wall(map, {4, 3}, {-4, 3});
  add_wall(map, {-4, 3}, {-4, -3});
  Points left;
  for (double x = -3.9; x < -1.0; x += 0.05) {
    for (double y = -2.9; y < 3.0; y += 0.05) {
      left.emplace_back(x, y);
    }
  }
  const LikelihoodGrid grid(map, kCellM, left);
  const CorrelativeMatch match =
      match_in_window(grid, seen_from({-2.0, 0.7, 0.2}, map), {{}, 4.0, 3.14}, kLimits);
  ASSERT_TRUE(match.is_unique());
  EXPECT_NEAR(match.peaks[0].T_target_base.x, -2.0, kCellM);
  EXPECT_NEAR(match.peaks[0].T_target_base.y, 0.7, kCellM);
}

}  // namespace correlative_match_test
}  // namespace nodmap::slam2d
