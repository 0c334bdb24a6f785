// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/matching/lattice_scores.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "modules/slam2d/test/random_points.hpp"

namespace nodmap::slam2d {
namespace lattice_scores_test {

using geometry::SE2;
using test::random_points;

PointMap map_of(const std::vector<OrientedPoint>& points) {
  PointMap map{MapParams{}};
  for (const OrientedPoint& point : points) {
    map.add(point);
  }
  return map;
}

// The oracle: a search of the map for each point at each place.
double score_by_searching(const PointMap& map, const std::vector<OrientedPoint>& scan,
                          const SE2& pose) {
  const Eigen::Matrix2d R = pose.rotation();
  double sum = 0.0;
  for (const auto& [p, normal] : scan) {
    const OrientedPoint point{R * p + pose.translation(), R * normal};
    if (const MapPoint* found = map.nearest(point, LatticeScores::kMaxDistanceM)) {
      sum += 1.0 - (found->point.p - point.p).norm() / LatticeScores::kMaxDistanceM;
    }
  }
  return sum / static_cast<double>(scan.size());
}

// To the last bit: which start poses are the best must not depend on how their scores were
// computed.
void expect_scores_of_a_search(const PointMap& map, const std::vector<OrientedPoint>& scan,
                               const SE2& middle, int steps) {
  LatticeScores scores(map, middle.translation(), steps);
  for (const double turn_rad : {0.0, 0.3, 2.5}) {
    const double yaw_rad = middle.yaw + turn_rad;
    scores.compute(scan, yaw_rad);
    for (int x = -steps; x <= steps; ++x) {
      for (int y = -steps; y <= steps; ++y) {
        const Eigen::Vector2d p_map = scores.position(x, y);
        ASSERT_EQ(scores.at(x, y), score_by_searching(map, scan, {p_map.x(), p_map.y(), yaw_rad}))
            << x << " " << y;
      }
    }
  }
}

TEST(LatticeScores, EqualThoseOfASearchAtEachPlace) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const PointMap map = map_of(random_points(800, seed, 3.0));
    const auto scan = random_points(60, seed + 10, 4.0);
    expect_scores_of_a_search(map, scan, {0.3, -0.2, 0.1}, 3);
    expect_scores_of_a_search(map, scan, {-57.0, 1234.5, -1.0}, 2);
    expect_scores_of_a_search(map, scan, {0.7, 0.4, -2.0}, 0);
  }
}

// All points lie on the corners of cells and lattice, so that many map points are just in reach.
TEST(LatticeScores, EqualThoseOfASearchWherePointsAreJustInReach) {
  std::vector<OrientedPoint> corners;
  for (int x = -8; x <= 8; ++x) {
    for (int y = -8; y <= 8; y += 1 + (x & 1)) {
      corners.push_back({{0.25 * x, 0.25 * y}, Eigen::Vector2d::Zero()});
    }
  }
  const std::vector<OrientedPoint> scan{{{0.25, 0.5}, {0, 1}}, {{-1.0, 0.125}, {1, 0}}};
  expect_scores_of_a_search(map_of(corners), scan, {}, 3);
}

TEST(LatticeScores, AnEmptyMapAndAnEmptyScanScoreZero) {
  const PointMap empty{MapParams{}};
  LatticeScores without_map(empty, {0.0, 0.0}, 2);
  without_map.compute(random_points(10, 1, 1.0), 0.0);
  EXPECT_EQ(without_map.at(2, -2), 0.0);
  const PointMap map = map_of(random_points(10, 1, 1.0));
  LatticeScores without_scan(map, {0.0, 0.0}, 2);
  without_scan.compute({}, 0.0);
  EXPECT_EQ(without_scan.at(0, 0), 0.0);
}

}  // namespace lattice_scores_test
}  // namespace nodmap::slam2d
