// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/behaviours/corridor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "common/geometry/angle.hpp"
#include "common/geometry/se2.hpp"

namespace nodmap::navigator {
namespace corridor_test {

constexpr double kInf = std::numeric_limits<double>::infinity();
const robot::Footprint kBody{0.225, 0.165};

// Oracle: moves the body in small steps until it covers the point.
double stepped_distance(const Eigen::Vector2d& p, double curvature, const robot::Footprint& shape) {
  constexpr double kStepM = 0.0005;
  geometry::SE2 T_start_base;
  for (double distance_m = 0.0;
       distance_m * std::abs(curvature) <= geometry::kPi && distance_m < 5.0;
       distance_m += kStepM) {
    if (shape.contains(T_start_base.inverse() * p)) {
      return distance_m;
    }
    // Half of the rotation before each step and half after it: an arc, up to errors of third order.
    T_start_base = T_start_base * geometry::SE2{0, 0, 0.5 * curvature * kStepM} *
                   geometry::SE2{kStepM, 0, 0} * geometry::SE2{0, 0, 0.5 * curvature * kStepM};
  }
  return kInf;
}

TEST(FreeDistance, StraightIsTheDistanceFromTheFront) {
  EXPECT_DOUBLE_EQ(free_distance({{1.0, 0.0}}, 0.0, kBody, 0.06), 0.775);
  EXPECT_DOUBLE_EQ(free_distance({{1.0, 0.224}}, 0.0, kBody, 0.06), 0.775);
  EXPECT_EQ(free_distance({{1.0, 0.226}}, 0.0, kBody, 0.06), kInf);
  EXPECT_EQ(free_distance({{-1.0, 0.0}}, 0.0, kBody, 0.06), kInf);
  EXPECT_EQ(free_distance({}, 0.0, kBody, 0.06), kInf);
}

// The virtual corridor's front and sides, to a millimetre; its top and bottom are tested with the
// map server.
TEST(FreeDistance, TheFrontAndSidesOfTheCorridorAreAtTheirMargins) {
  constexpr double kMarginM = 0.06;
  constexpr double kMm = 0.001;
  const double side_m = kBody.half_width_m + kMarginM;
  for (const double side : {-1.0, 1.0}) {
    for (const double ahead_m : {kBody.half_length_m + kMm, 1.0, 6.0}) {
      EXPECT_NEAR(free_distance({{ahead_m, side * (side_m - kMm)}}, 0.0, kBody, kMarginM),
                  ahead_m - kBody.half_length_m, 1e-12);
      EXPECT_EQ(free_distance({{ahead_m, side * (side_m + kMm)}}, 0.0, kBody, kMarginM), kInf);
    }
    EXPECT_EQ(free_distance({{-kBody.half_length_m - kMm, side * 0.1}}, 0.0, kBody, kMarginM),
              kInf);
  }
}

TEST(FreeDistance, OnArcsEqualsMovingTheBodyInSteps) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-0.9, 0.9);
  std::uniform_real_distribution<double> bend(-3.0, 3.0);
  const robot::Footprint grown = kBody.grown(0.0, 0.06);
  int touched = 0;
  for (int i = 0; i < 600; ++i) {
    const Eigen::Vector2d p(place(random), place(random));
    const double curvature = bend(random);
    if (grown.contains(p)) {
      continue;
    }
    const double exact_m = free_distance({p}, curvature, kBody, 0.06);
    const double stepped_m = stepped_distance(p, curvature, grown);
    // The steps miss a point that grazes the body between two of them; the exact distance does not.
    if (std::isinf(stepped_m)) {
      const double grazing_m = stepped_distance(p, curvature, grown.grown(0.002, 0.002));
      EXPECT_TRUE(std::isinf(exact_m) || std::isfinite(grazing_m)) << p.transpose();
      continue;
    }
    ++touched;
    const double first_m = stepped_distance(p, curvature, grown.grown(0.001, 0.001));
    EXPECT_GE(exact_m, first_m - 0.001) << p.transpose() << " " << curvature;
    EXPECT_LE(exact_m, stepped_m + 0.001) << p.transpose() << " " << curvature;
  }
  EXPECT_GT(touched, 80);
}

TEST(FreeDistance, TurningAwayFromAWallSwingsTheRearIntoIt) {
  // Driving straight on, the robot passes the wall on its right; turning left, its rear right
  // corner hits it.
  const Points wall{{-0.2, -0.24}, {-0.1, -0.24}, {0.0, -0.24}};
  EXPECT_EQ(free_distance(wall, 0.0, kBody, 0.06), kInf);
  EXPECT_LT(free_distance(wall, 2.0, kBody, 0.06), 0.2);
}

TEST(FreeDistance, APointWithinTheMarginDoesNotBlockTheRobot) {
  const Points beside{{0.0, 0.2}};
  EXPECT_EQ(free_distance(beside, 0.0, kBody, 0.06), kInf);  // drives past it
  EXPECT_LT(free_distance(beside, -2.0, kBody, 0.06), 0.5);  // but would swing the rear into it
  const Points touching{{0.1, 0.167}};
  EXPECT_EQ(free_distance(touching, -2.0, kBody, 0.06), kInf);  // drives away from it
  EXPECT_EQ(free_distance(touching, 2.0, kBody, 0.06), 0.0);
  const Points at_front{{0.226, 0.0}};
  EXPECT_LE(free_distance(at_front, 0.0, kBody, 0.06), 0.0011);
  EXPECT_EQ(free_distance_backwards(at_front, 0.0, kBody, 0.06), kInf);
}

TEST(FreeDistance, APointUnderTheBodyIsNotAnObstacle) {
  EXPECT_EQ(free_distance({{0.05, 0.05}}, 0.0, kBody, 0.06), kInf);
  EXPECT_EQ(free_rotation({{0.05, 0.05}}, Side::kLeft, kBody, 0.04), kInf);
}

TEST(FreeDistance, MirroredPointsGiveExactlyTheSame) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-1.5, 1.5);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d p(place(random), place(random));
    const double curvature = place(random);
    EXPECT_EQ(free_distance({p}, curvature, kBody, 0.06),
              free_distance({{p.x(), -p.y()}}, -curvature, kBody, 0.06));
    EXPECT_EQ(free_rotation({p}, Side::kLeft, kBody, 0.04),
              free_rotation({{p.x(), -p.y()}}, Side::kRight, kBody, 0.04));
  }
}

TEST(FreeDistanceBackwards, IsTheFreeDistanceOfAReversedRobot) {
  EXPECT_DOUBLE_EQ(free_distance_backwards({{-1.0, 0.1}}, 0.0, kBody, 0.02), 0.775);
  // Driving backwards along an arc to the left moves the robot to its left rear.
  EXPECT_LT(free_distance_backwards({{-0.8, 0.4}}, 1.0, kBody, 0.02), kInf);
  EXPECT_EQ(free_distance_backwards({{-0.8, 0.4}}, -1.0, kBody, 0.02), kInf);
}

TEST(FreeRotation, EqualsRotatingTheBodyInSteps) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.4, 0.4);
  const robot::Footprint grown = kBody.grown(0.04, 0.04);
  constexpr double kStepRad = 0.0005;
  int touched = 0;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d p(place(random), place(random));
    if (grown.contains(p)) {
      continue;
    }
    const double exact_rad = free_rotation({p}, Side::kRight, kBody, 0.04);
    double stepped_rad = 0.0;
    while (stepped_rad < 2.0 * geometry::kPi &&
           !grown.contains(geometry::SE2{0, 0, -stepped_rad}.inverse() * p)) {
      stepped_rad += kStepRad;
    }
    if (stepped_rad < 2.0 * geometry::kPi) {
      ++touched;
      // Four steps of the brute force.
      EXPECT_NEAR(exact_rad, stepped_rad, 0.002);
    } else {
      EXPECT_GT(p.norm(), std::hypot(0.265, 0.205) - 1e-4);
    }
  }
  EXPECT_GT(touched, 100);
}

}  // namespace corridor_test
}  // namespace nodmap::navigator
