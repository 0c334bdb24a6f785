// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/gyro_doubt.hpp"

#include <gtest/gtest.h>

#include <array>

#include "common/geometry/angle.hpp"

namespace nodmap::kurt {
namespace gyro_doubt_test {

using geometry::deg_to_rad;

constexpr double kIntervalS = 0.07;

// An interval in which both rotate by these degrees, on the spot.
void rotate(GyroDoubt& doubt, double gyro_deg, double wheels_deg) {
  doubt.add({.gyro_rad = deg_to_rad(gyro_deg), .wheels_rad = deg_to_rad(wheels_deg)}, kIntervalS);
}

TEST(GyroDoubt, WheelsMaySpinOrGripWithoutIt) {
  // An obstacle holds the robot; the wheels do not skid, to the left and to the right.
  const std::array<std::array<double, 2>, 3> rotations_deg{{{0.0, 5.0}, {7.0, 5.0}, {-7.0, -5.0}}};
  for (const auto& [gyro_deg, wheels_deg] : rotations_deg) {
    GyroDoubt doubt;
    for (int i = 0; i < 50; ++i) {
      rotate(doubt, gyro_deg, wheels_deg);
    }
    EXPECT_FALSE(doubt.is_active()) << gyro_deg;
  }
}

TEST(GyroDoubt, BeginsWithOneJump) {
  GyroDoubt doubt;
  rotate(doubt, 3.1, 0.0);  // margin: 3 degrees
  EXPECT_TRUE(doubt.is_active());
}

// Each interval is within the margin, their sum is not.
TEST(GyroDoubt, BeginsWithASlowRotationAgainstTheWheels) {
  GyroDoubt doubt;
  for (int i = 0; i < 3; ++i) {
    rotate(doubt, 1.0, -1.0);
    EXPECT_FALSE(doubt.is_active()) << i;
  }
  rotate(doubt, 1.0, -1.0);
  EXPECT_TRUE(doubt.is_active());
}

TEST(GyroDoubt, TheMarginGrowsWithThePath) {
  GyroDoubt doubt;
  doubt.add({.gyro_rad = deg_to_rad(12.9), .path_m = 1.0}, kIntervalS);  // margin: 3 + 10 degrees
  EXPECT_FALSE(doubt.is_active());
}

TEST(GyroDoubt, EndsOnceTheGyroHasFollowedTwentyDegrees) {
  GyroDoubt doubt;
  rotate(doubt, 90.0, 0.0);
  for (int i = 0; i < 100; ++i) {
    rotate(doubt, 0.0, 0.0);  // says nothing
  }
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(doubt.is_active()) << i;
    rotate(doubt, 5.1, 5.01);
  }
  EXPECT_FALSE(doubt.is_active());
}

TEST(GyroDoubt, AJumpLeavesNothingInTheSums) {
  GyroDoubt doubt;
  rotate(doubt, 90.0, 0.0);
  for (int i = 0; i < 4; ++i) {
    rotate(doubt, 5.1, 5.01);  // with 90 degrees in the sums these would be doubted, too
  }
  EXPECT_FALSE(doubt.is_active());
}

}  // namespace gyro_doubt_test
}  // namespace nodmap::kurt
