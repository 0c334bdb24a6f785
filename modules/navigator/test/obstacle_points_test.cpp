// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/obstacle_points.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace nodmap::navigator {
namespace obstacle_points_test {

using geometry::deg_to_rad;

TEST(ObstaclePoints, AnInconsistentMapIsRefused) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  constexpr auto kFar = std::numeric_limits<float>::infinity();
  using Bins = std::vector<float>;
  const auto points = read_points(Bins{kFar, 5.0F}, Bins{kNone, 3.0F}, Bins{kNone, 4.0F});
  ASSERT_TRUE(points);
  EXPECT_EQ(*points, (Points{{3.0, 4.0}}));
  EXPECT_FALSE(read_points(Bins{kNone}, Bins{1.0F}, Bins{0.0F}));
  EXPECT_FALSE(read_points(Bins{1.0F}, Bins{kNone}, Bins{0.0F}));
  EXPECT_FALSE(read_points(Bins{-1.0F}, Bins{1.0F}, Bins{0.0F}));
  EXPECT_FALSE(read_points(Bins{-kFar}, Bins{kNone}, Bins{kNone}));
  EXPECT_FALSE(read_points(Bins{2.0F}, Bins{1.0F}, Bins{0.0F}));
  EXPECT_FALSE(read_points(Bins{1.0F, 1.0F}, Bins{1.0F}, Bins{0.0F}));
  EXPECT_FALSE(read_points({}, {}, {}));
}

TEST(ObstaclePoints, ARobotThatTurnedRightSeesThePointOnItsLeft) {
  const auto points = move_to_base({{2.0, 0.0}}, {1, 1, 0}, {1, 1, deg_to_rad(-30)});
  EXPECT_NEAR(points[0].x(), 2.0 * std::cos(deg_to_rad(30)), 1e-12);
  EXPECT_NEAR(points[0].y(), 1.0, 1e-12);
  EXPECT_NEAR(move_to_base({{2.0, 0.0}}, {1, 1, 0}, {1.5, 1, 0})[0].x(), 1.5, 1e-12);
}

}  // namespace obstacle_points_test
}  // namespace nodmap::navigator
