// SPDX-License-Identifier: BSD-3-Clause
// Tests that the robot stops before narrow holes, wherever their corners lie across its path, at
// any moment of the nod, and behind a ramp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>

#include "modules/navigator/ground/test/profile.hpp"
#include "modules/navigator/local_map/test/braking_drive.hpp"

namespace nodmap::navigator {
namespace narrow_hole_test {

using test::BrakingDrive;
using test::Profile;

constexpr double kFar = 40.0;

// A pit with upright walls, along the axes of odom.
struct Pit {
  Profile ground;
  Eigen::Vector2d min;
  Eigen::Vector2d max;
  double depth_m;
  bool has_echo = true;

  // Range at which a ray meets the ground or, where it crosses that over the pit, the pit's walls
  // or bottom; +infinity without an echo.
  [[nodiscard]] double range_m(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) const {
    const double ground_m = ground.range_m(origin, ray);
    const Eigen::Vector2d p = (origin + std::min(ground_m, kFar) * ray).head<2>();
    if ((p.array() <= min.array()).any() || (p.array() >= max.array()).any()) {
      return ground_m;
    }
    if (!has_echo) {
      return std::numeric_limits<double>::infinity();
    }
    const double above_bottom_m = origin.z() - (ground.height_m(min.x()) - depth_m);
    double end_m = above_bottom_m / std::max(1e-9, -ray.z());
    for (int axis = 0; axis < 2; ++axis) {
      if (ray[axis] != 0.0) {
        const double wall = ray[axis] > 0.0 ? max[axis] : min[axis];
        end_m = std::min(end_m, (wall - origin[axis]) / ray[axis]);
      }
    }
    return end_m;
  }
};

// How far the body's front is from a pit on the robot's way, `length_m` long, once the robot has
// stopped for good; 0 or less: it has driven over it. In every other run only the pit's corner is
// in the way.
double drive_towards_pit(int run, Profile ground, double begins_m, double length_m, bool has_echo) {
  std::mt19937 engine(static_cast<std::uint32_t>(run));
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution(a, b)(engine);
  };
  const double speed_mps = between(0.3, 1.5);
  const double half_width_m = between(0.1, 0.7);
  const double depth_m = between(0.1, 1.0);
  const robot::Footprint body = robot::Body{}.footprint();
  const double under_body_m = between(0.0, run % 2 == 0 ? 0.08 : body.half_width_m);
  const double aside_m =
      (half_width_m + body.half_width_m - under_body_m) * (run % 4 < 2 ? 1.0 : -1.0);
  const Pit pit{std::move(ground),
                {begins_m, aside_m - half_width_m},
                {begins_m + length_m, aside_m + half_width_m},
                depth_m,
                has_echo};
  BrakingDrive drive([&](const Eigen::Vector3d& origin,
                         const Eigen::Vector3d& ray) { return pit.range_m(origin, ray); },
                     speed_mps, static_cast<std::uint32_t>(run),
                     [&](double x) { return pit.ground.pose_at(x); });
  return drive.until(begins_m - body.half_length_m);
}

// In eight parts, which run beside each other.
class NarrowHole : public ::testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(Parts, NarrowHole, ::testing::Range(0, 8));

// Seen from the distance of a stop, the beams that enter so narrow a hole end on its far wall, no
// lower than a ramp could be there; those that enter it in its last 7 to 10 cm look like floor. If
// such a place counted only beside what is certainly a hole, the robot would drive over 9 of these.
TEST_P(NarrowHole, TheRobotStopsBeforeItAtAnySpeedAndMomentOfTheNod) {
  for (int run = GetParam(); run < 64; run += 8) {
    std::mt19937 engine(static_cast<std::uint32_t>(run));
    const double begins_m = std::uniform_real_distribution(2.5, 4.0)(engine);
    const double length_m = std::uniform_real_distribution(0.2, 0.3)(engine);
    EXPECT_GT(drive_towards_pit(run, {{{-kFar, 0.0}, {kFar, 0.0}}}, begins_m, length_m, true), 0.0)
        << "run " << run << ": " << length_m << " m long";
  }
}

// Behind a ramp down or up, with the ground known in several facets. Half of the holes bring no
// echo. The robot passes the ramp and stops before the hole: its stop margin and the hole's edge
// are 0.25 m, and where the hole begins close behind the kink it may stop 0.4 m earlier.
TEST_P(NarrowHole, TheRobotStopsBeforeItBehindARamp) {
  for (int run = GetParam(); run < 32; run += 8) {
    std::mt19937 engine(static_cast<std::uint32_t>(run));
    const auto between = [&](double a, double b) {
      return std::uniform_real_distribution(a, b)(engine);
    };
    const double from_m = between(2.5, 4.0);
    const double to_m = from_m + between(1.2, 2.5);
    const double rise_m = (to_m - from_m) * std::tan(geometry::deg_to_rad(between(5.0, 12.0))) *
                          (run % 8 < 4 ? -1.0 : 1.0);
    const double begins_m = to_m + between(0.0, 2.0);
    const double length_m = between(0.2, 0.3);
    const Profile ramp{{{-kFar, 0.0}, {from_m, 0.0}, {to_m, rise_m}, {kFar, rise_m}}};
    const double left_m = drive_towards_pit(run, ramp, begins_m, length_m, run % 16 < 8);
    EXPECT_GT(left_m, 0.0) << "run " << run;
    EXPECT_LT(left_m, 0.65) << "run " << run;
  }
}

}  // namespace narrow_hole_test
}  // namespace nodmap::navigator
