// SPDX-License-Identifier: BSD-3-Clause
#include "common/geometry/pose_tolerance.hpp"

#include <gtest/gtest.h>

#include "common/geometry/angle.hpp"

namespace nodmap::geometry {
namespace pose_tolerance_test {

constexpr PoseTolerance kTolerance{.distance_m = 0.5, .rotation_rad = 0.2};

// The same in the plane and in space.
void expect_within(bool is_within_tolerance, const SE2& a, const SE2& b) {
  EXPECT_EQ(is_within(a, b, kTolerance), is_within_tolerance);
  EXPECT_EQ(is_within(b, a, kTolerance), is_within_tolerance);
  EXPECT_EQ(is_within(to_se3(a), to_se3(b), kTolerance), is_within_tolerance);
}

TEST(PoseTolerance, BothDistanceAndRotationMustBeMet) {
  const SE2 a{3.0, -4.0, 1.0};
  expect_within(true, a, a);
  expect_within(true, a, {3.29, -3.61, 1.19});  // 0.486 m
  expect_within(false, a, {3.31, -3.59, 1.0});  // 0.514 m
  expect_within(false, a, {3.0, -4.0, 1.21});
}

TEST(PoseTolerance, HeadingsAreComparedAcross180Degrees) {
  expect_within(true, {0.0, 0.0, kPi - 0.09}, {0.0, 0.0, -kPi + 0.09});
  expect_within(false, {0.0, 0.0, kPi - 0.11}, {0.0, 0.0, -kPi + 0.11});
}

}  // namespace pose_tolerance_test
}  // namespace nodmap::geometry
