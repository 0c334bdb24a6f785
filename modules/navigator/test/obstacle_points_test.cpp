// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/obstacle_points.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::navigator {
namespace obstacle_points_test {

using geometry::deg_to_rad;

TEST(ObstaclePoints, ARobotThatTurnedRightSeesThePointOnItsLeft) {
  const auto points = move_to_base({{2.0, 0.0}}, {1, 1, 0}, {1, 1, deg_to_rad(-30)});
  EXPECT_NEAR(points[0].x(), 2.0 * std::cos(deg_to_rad(30)), 1e-12);
  EXPECT_NEAR(points[0].y(), 1.0, 1e-12);
  EXPECT_NEAR(move_to_base({{2.0, 0.0}}, {1, 1, 0}, {1.5, 1, 0})[0].x(), 1.5, 1e-12);
}

}  // namespace obstacle_points_test
}  // namespace nodmap::navigator
