// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/corridor_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace nodmap::evaluate {
namespace corridor_error_test {

using geometry::SE2;
using geometry::SE3;
using geometry::to_se3;

// Sums and rotations of numbers up to 30: rounding.
constexpr double kRounding = 1e-12;
const SE3 kElsewhere = to_se3({3.0, -7.0, 2.5});
const SE3 kNorth = to_se3({1.0, 2.0, std::numbers::pi / 2.0});

// 31 poses, 1 m apart, along the true x axis; `bend` gives their estimates.
template <class Bend>
std::vector<PosePair> drive(const Bend& bend) {
  std::vector<PosePair> pairs;
  for (int i = 0; i <= 30; ++i) {
    const double x = i;
    pairs.push_back({to_se3(bend(x)), to_se3({x, 0.0, 0.0})});
  }
  return pairs;
}

TEST(CorridorError, TheTruthHasNone) {
  const auto errors = measure_corridor(drive([](double x) { return SE2{x, 0.0, 0.0}; }));
  ASSERT_TRUE(errors);
  EXPECT_EQ(errors->length_m, 30.0);
  EXPECT_EQ(errors->length_error_m, 0.0);
  EXPECT_EQ(errors->bow_m, 0.0);
  EXPECT_EQ(errors->heading_error_rad, 0.0);
}

TEST(CorridorError, AStretchedMapIsTooLongAndNothingElse) {
  const auto errors = measure_corridor(drive([](double x) { return SE2{1.02 * x, 0.0, 0.0}; }));
  EXPECT_NEAR(errors->length_error_m, 0.6, kRounding);
  EXPECT_NEAR(errors->bow_m, 0.0, kRounding);
  const auto shrunk = measure_corridor(drive([](double x) { return SE2{0.98 * x, 0.0, 0.0}; }));
  EXPECT_NEAR(shrunk->length_error_m, -0.6, kRounding);
}

TEST(CorridorError, TheBowCountsWhereItIsWidest) {
  // A parabola that returns to the axis: 0.2 m to the side in the middle.
  const auto errors = measure_corridor(drive([](double x) {
    return SE2{x, 0.2 - 0.2 * std::pow((x - 15.0) / 15.0, 2.0), 0.0};
  }));
  EXPECT_NEAR(errors->bow_m, 0.2, kRounding);
  EXPECT_NEAR(errors->length_error_m, 0.0, kRounding);
}

TEST(CorridorError, TheHeadingCountsWhereItIsWorstAndAcrossTheSeam) {
  const auto errors = measure_corridor(drive([](double x) {
    return SE2{x, 0.0, x == 12.0 ? -0.01 : (x == 20.0 ? 0.004 : 0.0)};
  }));
  EXPECT_NEAR(errors->heading_error_rad, 0.01, kRounding);
  // Driving towards -x, the headings lie on both sides of the seam at pi.
  const double pi = std::numbers::pi;
  const std::vector<PosePair> back = {{to_se3({0, 0, pi}), to_se3({0, 0, pi})},
                                      {to_se3({-9, 0, 0.005 - pi}), to_se3({-9, 0, pi - 0.005})}};
  EXPECT_NEAR(measure_corridor(back)->heading_error_rad, 0.01, kRounding);
}

TEST(CorridorError, DoesNotDependOnTheFrames) {
  const auto bend = [](double x) { return SE2{1.01 * x, 0.001 * x * x, 0.002 * x}; };
  auto pairs = drive(bend);
  const auto errors = measure_corridor(pairs);
  for (PosePair& pair : pairs) {
    pair.T_map_base = kElsewhere * pair.T_map_base;
    pair.T_truth_base = kNorth * pair.T_truth_base;
  }
  const auto moved = measure_corridor(pairs);
  EXPECT_NEAR(moved->length_m, errors->length_m, kRounding);
  EXPECT_NEAR(moved->length_error_m, errors->length_error_m, kRounding);
  EXPECT_NEAR(moved->bow_m, errors->bow_m, kRounding);
  EXPECT_NEAR(moved->heading_error_rad, errors->heading_error_rad, kRounding);
}

TEST(CorridorError, WithoutAPathThereIsNoCorridor) {
  EXPECT_FALSE(measure_corridor({}));
  const PosePair standing{SE3::Identity(), SE3::Identity()};
  EXPECT_FALSE(measure_corridor({standing, standing}));
}

}  // namespace corridor_error_test
}  // namespace nodmap::evaluate
