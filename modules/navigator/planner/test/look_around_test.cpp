// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/look_around.hpp"

#include <gtest/gtest.h>

#include "common/geometry/angle.hpp"

namespace nodmap::navigator {
namespace look_around_test {

using geometry::deg_to_rad;

constexpr time::Timestamp kStart{100s};

// Rotates to the left by 10 degrees 36 times, from 2 s after the start on.
void rotate_once(LookAround& look_around) {
  for (int i = 0; i < 36; ++i) {
    EXPECT_TRUE(look_around.wants_rotation()) << i;
    EXPECT_FALSE(look_around.take_end()) << i;
    // Half a degree more in all, so that rounding does not matter.
    look_around.step(kStart + 2s, deg_to_rad(10.02 * (i + 1)));
  }
}

TEST(LookAround, RotatesOnceAndAgainHalfAMinuteLater) {
  LookAround look_around;
  look_around.step(kStart, 0.0);
  EXPECT_FALSE(look_around.wants_rotation());
  look_around.step(kStart + 1001ms, 0.0);
  EXPECT_TRUE(look_around.wants_rotation());
  rotate_once(look_around);
  EXPECT_FALSE(look_around.wants_rotation());
  EXPECT_TRUE(look_around.take_end());
  EXPECT_FALSE(look_around.take_end());
  look_around.step(kStart + 30s, 0.0);
  EXPECT_FALSE(look_around.wants_rotation());
  EXPECT_TRUE(look_around.step(kStart + 31s, 0.0));
  look_around.step(kStart + 33s, 0.0);
  EXPECT_TRUE(look_around.wants_rotation());
}

// What is forgotten then may be just what leaves no path: the robot would drive round for ever.
TEST(LookAround, AfterAPathInBetweenItRotatesAnewButEndsOnce) {
  LookAround look_around;
  look_around.step(kStart, 0.0);
  look_around.step(kStart + 2s, 0.0);
  rotate_once(look_around);
  EXPECT_TRUE(look_around.take_end());
  look_around.pause();
  look_around.step(kStart + 3s, 0.0);
  look_around.step(kStart + 5s, 0.0);
  EXPECT_TRUE(look_around.wants_rotation());
  look_around.end();
  EXPECT_FALSE(look_around.take_end());
  EXPECT_TRUE(look_around.step(kStart + 34s, 0.0));
  look_around.end();
  EXPECT_TRUE(look_around.take_end());
}

TEST(LookAround, EndsWhereTheRobotCannotRotateFarther) {
  LookAround look_around;
  look_around.step(kStart, 0.0);
  look_around.step(kStart + 2s, 1.0);
  look_around.end();
  EXPECT_FALSE(look_around.wants_rotation());
  EXPECT_TRUE(look_around.take_end());
  look_around.reset();
  EXPECT_FALSE(look_around.take_end());
}

}  // namespace look_around_test
}  // namespace nodmap::navigator
