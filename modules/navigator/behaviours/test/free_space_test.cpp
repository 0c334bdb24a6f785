// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/behaviours/free_space.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "common/geometry/angle.hpp"
#include "modules/navigator/test/point_world.hpp"

namespace nodmap::navigator {
namespace free_space_test {

using geometry::deg_to_rad;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kOpenSpaceM = 1.0;
const robot::Footprint kBody{0.225, 0.165};

FreeSpace measure(const Points& points) {
  return measure_free_space(points, kBody, 0.06);
}

Points mirrored(Points points) {
  for (auto& p : points) {
    p.y() = -p.y();
  }
  return points;
}

Points random_clutter(std::mt19937& random) {
  std::uniform_real_distribution<double> place(-3.0, 3.0);
  Points points;
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector2d p(place(random), place(random));
    if (p.norm() > 0.35) {
      points.push_back(p);
    }
  }
  return points;
}

TEST(FreeSpace, EachDirectionEqualsAStraightCorridorInARotatedFrame) {
  std::mt19937 random(1);
  for (int round = 0; round < 50; ++round) {
    Points points = random_clutter(random);
    // Next to the body the two differ on purpose: a point beside the body does not block a
    // direction.
    std::erase_if(points, [](const Eigen::Vector2d& p) { return p.norm() < 0.5; });
    const FreeSpace space = measure(points);
    for (int degree = -90; degree <= 90; degree += 7) {
      Points turned = points;
      for (auto& p : turned) {
        p = geometry::SE2{0, 0, deg_to_rad(degree)}.inverse() * p;
      }
      const double straight_m = free_distance(turned, 0.0, kBody, 0.06);
      if (std::isinf(straight_m)) {
        EXPECT_EQ(space.at(degree), kInf);
      } else {
        EXPECT_NEAR(space.at(degree), straight_m, 1e-9);
      }
    }
  }
}

TEST(FreeSpace, AGapNarrowerThanTheRobotIsNotFree) {
  EXPECT_LT(measure({{1.0, 0.2}, {1.0, -0.2}}).at(0), 1.0);
  EXPECT_EQ(measure({{1.0, 0.24}, {1.0, -0.24}}).at(0), kInf);
}

TEST(Steer, DrivesStraightInASymmetricCorridor) {
  test::World world;
  world.add_wall({-2, 0.6}, {8, 0.6});
  world.add_wall({-2, -0.6}, {8, -0.6});
  const auto alpha = free_space_orientation(measure(test::ideal_map(world, {})), 0.0, kOpenSpaceM);
  ASSERT_TRUE(alpha);
  EXPECT_LT(std::abs(*alpha), deg_to_rad(1.0));  // R28
}

TEST(Steer, SteersAwayFromAWallToTheOpenSide) {
  test::World world;
  world.add_wall({-2, -0.5}, {8, -0.5});  // on the right
  const auto alpha = free_space_orientation(measure(test::ideal_map(world, {})), 0.0, kOpenSpaceM);
  ASSERT_TRUE(alpha);
  EXPECT_GT(*alpha, deg_to_rad(10.0));
}

TEST(Steer, MirroredInputGivesExactlyMirroredOutput) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    const Points points = random_clutter(random);
    const FreeSpace space = measure(points);
    const FreeSpace mirror = measure(mirrored(points));
    const double wanted_rad = deg_to_rad(round % 60);
    const auto alpha = free_space_orientation(space, wanted_rad, kOpenSpaceM);
    const auto beta = free_space_orientation(mirror, -wanted_rad, kOpenSpaceM);
    ASSERT_EQ(alpha.has_value(), beta.has_value());
    if (!alpha) {
      continue;
    }
    EXPECT_EQ(*alpha, -*beta);
    const FreeNeighbours near = free_neighbours(space, *alpha, 1.0);
    const FreeNeighbours far = free_neighbours(mirror, *beta, 1.0);
    ASSERT_EQ(near.left_rad.has_value(), far.right_rad.has_value());
    if (near.left_rad) {
      EXPECT_EQ(*near.left_rad, -*far.right_rad);
    }
    EXPECT_EQ(side_with_more_room(space), opposite(side_with_more_room(mirror)));
  }
}

TEST(Steer, WithoutFreeSpaceThereIsNoOrientation) {
  FreeSpace space;  // no free distance anywhere
  // With no free distance g(0) is 0.018 in every direction, which still gives an orientation. Below
  // the threshold there is none.
  EXPECT_TRUE(free_space_orientation(space, 0.0, 1.0));
  EXPECT_FALSE(free_space_orientation(space, 0.0, 4.0));
}

TEST(Steer, BetweenTwoDoorsTheNearestFreeDirectionsAreTheDoors) {
  FreeSpace space;
  for (int degree = 20; degree <= 40; ++degree) {
    space.at(degree) = 3.0;
    space.at(-degree - 5) = 3.0;
  }
  const FreeNeighbours near = free_neighbours(space, 0.0, 1.0);
  EXPECT_EQ(near.left_rad, deg_to_rad(20));
  EXPECT_EQ(near.right_rad, deg_to_rad(-25));
  EXPECT_EQ(free_neighbours(space, deg_to_rad(30), 1.0).right_rad, deg_to_rad(30));
  EXPECT_FALSE(free_neighbours(space, 0.0, 3.5).left_rad);
}

// Steer and Turn go by the former, Brake by the latter. They differ only for points a little within
// the body: all those before its middle block the former, only those at its front the latter.
TEST(FreeSpace, AheadItIsNoLongerThanTheVirtualCorridor) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  constexpr double kMarginM = 0.06;
  for (int i = 0; i < 5000; ++i) {
    const Points point{{place(random), place(random)}};
    const double ahead_m = measure_free_space(point, kBody, kMarginM).at(0);
    const double corridor_m = free_distance(point, 0.0, kBody, kMarginM);
    EXPECT_LE(ahead_m, corridor_m) << point[0].transpose();
    if (!kBody.grown(0.0, kMarginM).contains(point[0])) {
      EXPECT_EQ(ahead_m, corridor_m) << point[0].transpose();
    }
  }
}

}  // namespace free_space_test
}  // namespace nodmap::navigator
