// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/score_bound.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace nodmap::slam2d {
namespace score_bound_test {

constexpr double kMaxDistanceM = 0.25;

std::vector<Eigen::Vector2d> random_points(int count, unsigned seed, double half_size_m) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-half_size_m, half_size_m);
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < count; ++i) {
    points.emplace_back(coordinate(random), coordinate(random));
  }
  return points;
}

PointMap map_of(const std::vector<Eigen::Vector2d>& points) {
  PointMap map{MapParams{}};
  for (const Eigen::Vector2d& point : points) {
    map.add({point, Eigen::Vector2d::Zero()});
  }
  return map;
}

// The oracle: the mean score of the points, by brute force.
double true_score(const std::vector<Eigen::Vector2d>& map, const std::vector<Eigen::Vector2d>& scan,
                  const Eigen::Vector2d& shift_m) {
  double sum = 0.0;
  for (const Eigen::Vector2d& point : scan) {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector2d& other : map) {
      nearest_m = std::min(nearest_m, (other - point - shift_m).norm());
    }
    sum += std::max(0.0, 1.0 - nearest_m / kMaxDistanceM);
  }
  return sum / static_cast<double>(scan.size());
}

TEST(ScoreBound, IsNeverBelowTheScoreAndNotFarAbove) {
  const auto points = random_points(300, 1, 4.0);
  const auto scan = random_points(20, 2, 4.0);
  const ScoreBound bound(map_of(points), {0.3, -0.2}, kMaxDistanceM, 6);
  const auto cells = bound.cells_of(scan);
  for (int x = -6; x <= 6; ++x) {
    for (int y = -6; y <= 6; ++y) {
      const double score = true_score(points, scan, ScoreBound::kCellM * Eigen::Vector2d(x, y));
      EXPECT_GE(bound.at(cells, x, y), score);
      // The bound exceeds the score of a point by at most the change of the score over a cell's
      // diagonal, plus rounding to 1/255.
      EXPECT_LE(bound.at(cells, x, y),
                score + std::sqrt(2.0) * ScoreBound::kCellM / kMaxDistanceM + 0.005);
    }
  }
}

TEST(ScoreBound, HoldsFarFromTheCentre) {
  const std::vector<Eigen::Vector2d> points{{100.0, 0.0}, {19.9, 0.0}, {-20.7, -20.7}};
  const ScoreBound bound(map_of(points), {0.0, 0.0}, kMaxDistanceM, 6);
  for (const Eigen::Vector2d& point : points) {
    EXPECT_EQ(bound.at(bound.cells_of({&point, 1}), 0, 0), 1.0);
    EXPECT_GT(bound.at(bound.cells_of({&point, 1}), -1, 1), 0.0);
  }
}

TEST(ScoreBound, AnEmptyMapAndAnEmptyScanScoreZero) {
  const ScoreBound bound(PointMap{MapParams{}}, {0.0, 0.0}, kMaxDistanceM, 2);
  const std::vector<Eigen::Vector2d> scan{{1.0, 2.0}};
  EXPECT_EQ(bound.at(bound.cells_of(scan), 2, -2), 0.0);
  EXPECT_EQ(bound.at({}, 0, 0), 0.0);
}

}  // namespace score_bound_test
}  // namespace nodmap::slam2d
