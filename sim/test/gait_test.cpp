// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/gait.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace nodmap::sim {
namespace gait_test {

using Eigen::Vector2d;

TEST(Gait, AStationaryPersonStandsOnBothLegs) {
  Gait gait({3.0, 1.0});
  gait.move_to({3.0, 1.0});
  EXPECT_EQ(gait.legs().left, Vector2d(3.0, 1.1));
  EXPECT_EQ(gait.legs().right, Vector2d(3.0, 0.9));
}

TEST(Gait, LegsSwingAgainstEachOtherAndAreInTheSamePlaceAfterAStride) {
  Gait gait({0.0, 0.0});
  auto walk_to = [&gait, y = 0.0](double to) mutable {
    for (; y < to; y += 0.001) {
      gait.move_to({0.0, y});
    }
    gait.move_to({0.0, to});
    return gait.legs();
  };
  const Legs swung = walk_to(0.35);  // a quarter of a stride
  EXPECT_NEAR(swung.left.y(), 0.35 + 0.18, 1e-9);
  EXPECT_NEAR(swung.right.y(), 0.35 - 0.18, 1e-9);
  EXPECT_NEAR(swung.left.x(), -0.1, 1e-9) << "it walks along y";
  const Legs half = walk_to(1.05);
  EXPECT_NEAR(half.left.y(), 1.05 - 0.18, 1e-9) << "the other leg is ahead";
  const Legs stride = walk_to(1.75);
  EXPECT_NEAR(stride.left.y(), 1.75 + 0.18, 1e-9);
}

// As an actor that begins its round anew.
TEST(Gait, AJumpIsNoStep) {
  Gait gait({0.0, 0.0});
  gait.move_to({5.0, 5.0});
  EXPECT_EQ(gait.legs().left, Vector2d(5.0, 5.1));
}

}  // namespace gait_test
}  // namespace nodmap::sim
