// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/view.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/geometry/angle.hpp"

namespace nodmap::slam2d {
namespace view_test {

struct Box {
  Eigen::Vector2d low;
  Eigen::Vector2d high;
};

// Range to the nearest box, which may contain the origin (slab method).
double range_m(const std::vector<Box>& boxes, const Eigen::Vector2d& origin, double angle_rad) {
  const Eigen::Vector2d ray(std::cos(angle_rad), std::sin(angle_rad));
  double nearest = std::numeric_limits<double>::infinity();
  for (const Box& box : boxes) {
    double enter = -std::numeric_limits<double>::infinity();
    double leave = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 2; ++axis) {
      const double a = (box.low[axis] - origin[axis]) / ray[axis];
      const double b = (box.high[axis] - origin[axis]) / ray[axis];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (enter <= leave && leave > 0.0) {
      nearest = std::min(nearest, enter > 0.0 ? enter : leave);
    }
  }
  return nearest;
}

// The view of a scanner on the robot: a half circle of beams, one degree apart. None of them is
// parallel to a side of the boxes if the robot is not rotated.
View look(const std::vector<Box>& boxes, const geometry::SE2& T_world_base) {
  std::vector<Eigen::Vector2d> points;
  for (double deg = -89.7; deg < 90.0; deg += 1.0) {
    const double angle_rad = geometry::deg_to_rad(deg);
    const double range = range_m(boxes, T_world_base.translation(), T_world_base.yaw + angle_rad);
    points.emplace_back(range * std::cos(angle_rad), range * std::sin(angle_rad));
  }
  return {points, Eigen::Vector2d::Zero()};
}

// A room of 12 m x 2.5 m with walls across it, which leave 0.8 m free alternately on one side and
// on the other.
std::vector<Box> zigzag() {
  std::vector<Box> boxes{{{-1.0, -1.25}, {11.0, 1.25}}};
  for (int i = 0; i < 6; ++i) {
    const double x = 1.0 + 1.5 * i;
    boxes.push_back(i % 2 == 0 ? Box{{x, -1.25}, {x + 0.1, 0.45}}
                               : Box{{x, -0.45}, {x + 0.1, 1.25}});
  }
  return boxes;
}

TEST(View, SpaceIsFreeUpTo30CentimetresBeforeTheWall) {
  const View view = look({{{-1.0, -2.0}, {4.0, 2.0}}}, {});
  EXPECT_TRUE(view.saw_free({3.6, 0.0}));
  EXPECT_FALSE(view.saw_free({3.8, 0.0}));
  EXPECT_FALSE(view.saw_free({5.0, 0.0}));
  EXPECT_FALSE(view.saw_free({-0.5, 0.0})) << "behind, where it does not look";
}

TEST(View, ViewsOfTheSamePlaceContradictNothing) {
  const std::vector<Box> world = zigzag();
  const std::vector<geometry::SE2> poses{
      {0.0, 0.0, 0.0}, {0.3, 0.2, 0.5}, {1.8, 0.8, -0.7}, {1.9, 0.0, -1.6}, {2.1, -0.8, 0.3}};
  for (const geometry::SE2& a : poses) {
    for (const geometry::SE2& b : poses) {
      EXPECT_FALSE(look(world, a).contradicts(look(world, b), a.inverse() * b));
    }
  }
}

TEST(View, AWallInTheFreeSpaceOfAnotherViewIsAContradiction) {
  // The first pose is in front of the wall at x = 1 m. The second is 1.5 m farther on, where the
  // next wall leaves this side free.
  const geometry::SE2 before_wall{1.6, -0.7, geometry::kPi};
  const geometry::SE2 before_gap{3.1, -0.7, geometry::kPi};
  const View wall = look(zigzag(), before_wall);
  const View gap = look(zigzag(), before_gap);
  EXPECT_TRUE(wall.contradicts(gap, {}));
  EXPECT_TRUE(gap.contradicts(wall, {})) << "in both directions";
  EXPECT_FALSE(wall.contradicts(gap, before_wall.inverse() * before_gap))
      << "at the true relative pose";
}

TEST(View, NothingContradictsAnEmptyView) {
  const View view = look(zigzag(), {});
  const View empty({}, Eigen::Vector2d::Zero());
  EXPECT_FALSE(view.contradicts(empty, {}));
  EXPECT_FALSE(empty.contradicts(view, {}));
}

}  // namespace view_test
}  // namespace nodmap::slam2d
