// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/matching/scan_matcher.hpp"

#include <gtest/gtest.h>

#include "modules/slam2d/test/drawn_world.hpp"

namespace nodmap::slam2d {
namespace scan_matcher_test {

using geometry::SE2;

PointMap map_of(const test::FloorPlan& plan, const SE2& seen_from) {
  test::Scanner scanner(0.0);
  OrientedPointExtractor extractor;
  PointMap map{{.line_radius_m = 0.25}};
  const auto points = extractor.extract(scanner.scan(plan, seen_from), {});
  for (const OrientedPoint& point : transformed(seen_from, points)) {
    map.add(point);
  }
  return map;
}

class ScanMatcherMetrics : public testing::TestWithParam<ErrorMetric> {};

TEST_P(ScanMatcherMetrics, R34_AnErrorOfTheGuessIsCorrected) {
  MatcherParams params;
  params.metric = GetParam();
  params.max_iterations = 100;
  const PointMap map = map_of(test::room(), {});
  test::Scanner scanner(0.01);
  OrientedPointExtractor extractor;
  const SE2 truth{0.2, -0.1, 0.1};
  const auto points = extractor.extract(scanner.scan(test::room(), truth), {});
  for (const SE2& error : {SE2{0.15, 0.1, 0.1}, SE2{-0.15, 0.1, -0.1}, SE2{0.0, -0.2, 0.05}}) {
    const Match match = ScanMatcher(params).match(
        map, points, {truth.x + error.x, truth.y + error.y, truth.yaw + error.yaw});
    EXPECT_EQ(match.degenerate_directions, 0);
    EXPECT_GT(match.inlier_ratio, 0.9);
    // A noise of 1 cm on some 90 points for each axis gives an error of 1 mm. But the map is a
    // single scan with gaps of 10 cm and rounded corners, which have their full effect on the
    // point-to-point metric.
    const double tolerance = GetParam() == ErrorMetric::kPointToLine ? 0.01 : 0.03;
    EXPECT_NEAR(match.T_target_base.x, truth.x, tolerance);
    EXPECT_NEAR(match.T_target_base.y, truth.y, tolerance);
    EXPECT_NEAR(match.T_target_base.yaw, truth.yaw, tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(Metrics, ScanMatcherMetrics,
                         testing::Values(ErrorMetric::kPointToLine, ErrorMetric::kPointToPoint));

TEST(ScanMatcher, R37_TheAxisOfACorridorStaysAtTheGuess) {
  const PointMap map = map_of(test::corridor(), {});
  test::Scanner scanner(0.01);
  OrientedPointExtractor extractor;
  const auto points = extractor.extract(scanner.scan(test::corridor(), {}), {});
  const Match match = ScanMatcher(MatcherParams{}).match(map, points, {0.3, 0.15, 0.05});
  EXPECT_EQ(match.degenerate_directions, 1);
  // Across the corridor and in heading the pose is as exact as anywhere. Along it the pose stays at
  // the guess, apart from the initial heading error, which mixes in at most 0.05 rad times the 0.15
  // m across.
  EXPECT_NEAR(match.T_target_base.x, 0.3, 0.03);
  EXPECT_NEAR(match.T_target_base.y, 0.0, 0.01);
  EXPECT_NEAR(match.T_target_base.yaw, 0.0, 0.01);
}

TEST(ScanMatcher, WithoutCorrespondencesThePoseStaysAtTheGuess) {
  const PointMap map = map_of(test::room(), {});
  const ScanMatcher matcher{MatcherParams{}};
  const SE2 guess{100.0, 0.0, 1.0};
  for (const std::vector<OrientedPoint>& scan :
       {std::vector<OrientedPoint>{}, std::vector<OrientedPoint>(20, {{1, 1}, {0, 0}})}) {
    const Match match = matcher.match(map, scan, guess);
    EXPECT_FALSE(match.found());
    EXPECT_EQ(match.score, 0.0);
    EXPECT_EQ(match.T_target_base.x, guess.x);
    EXPECT_EQ(match.T_target_base.yaw, guess.yaw);
  }
  EXPECT_FALSE(matcher.match(PointMap(MapParams{}), std::vector<OrientedPoint>(20), {}).found());
}

}  // namespace scan_matcher_test
}  // namespace nodmap::slam2d
