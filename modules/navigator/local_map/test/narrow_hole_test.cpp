// SPDX-License-Identifier: BSD-3-Clause
// Tests that the robot stops before narrow holes, wherever their corners lie across its path and at
// any moment of the nod.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "modules/navigator/local_map/test/braking_drive.hpp"

namespace nodmap::navigator {
namespace narrow_hole_test {

using test::BrakingDrive;

// A pit with upright walls, along the axes of odom.
struct Pit {
  Eigen::Vector2d min;
  Eigen::Vector2d max;
  double depth_m;

  // Range at which a ray meets the floor or, where it crosses that over the pit, the pit's walls or
  // bottom; +infinity if it leads upwards.
  [[nodiscard]] double range_m(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) const {
    if (ray.z() >= 0.0) {
      return std::numeric_limits<double>::infinity();
    }
    const double floor_m = -origin.z() / ray.z();
    const Eigen::Vector2d p = (origin + floor_m * ray).head<2>();
    if ((p.array() <= min.array()).any() || (p.array() >= max.array()).any()) {
      return floor_m;
    }
    double end_m = (origin.z() + depth_m) / -ray.z();
    for (int axis = 0; axis < 2; ++axis) {
      if (ray[axis] != 0.0) {
        const double wall = ray[axis] > 0.0 ? max[axis] : min[axis];
        end_m = std::min(end_m, (wall - origin[axis]) / ray[axis]);
      }
    }
    return end_m;
  }
};

// Seen from the distance of a stop, the beams that enter so narrow a hole end on its far wall, no
// lower than a ramp could be there; those that enter it in its last 7 to 10 cm look like floor. If
// such a place counted only beside what is certainly a hole, the robot would drive over 9 of these.
TEST(NarrowHole, TheRobotStopsBeforeItAtAnySpeedAndMomentOfTheNod) {
  for (int run = 0; run < 64; ++run) {
    std::mt19937 engine(static_cast<std::uint32_t>(run));
    const auto between = [&](double a, double b) {
      return std::uniform_real_distribution(a, b)(engine);
    };
    const double speed_mps = between(0.3, 1.5);
    const double half_width_m = between(0.1, 0.7);
    const double x_m = between(2.5, 4.0);
    const double length_m = between(0.2, 0.3);
    const double depth_m = between(0.1, 1.0);
    // In every other run only its corner is in the way.
    const double under_body_m = run % 2 == 0 ? between(0.0, 0.08) : between(0.0, 0.165);
    const double aside_m = (half_width_m + 0.165 - under_body_m) * (run % 4 < 2 ? 1.0 : -1.0);
    const Pit pit{{x_m, aside_m - half_width_m}, {x_m + length_m, aside_m + half_width_m}, depth_m};
    BrakingDrive drive([&](const Eigen::Vector3d& origin,
                           const Eigen::Vector3d& ray) { return pit.range_m(origin, ray); },
                       speed_mps, static_cast<std::uint32_t>(run));
    EXPECT_GT(drive.until(x_m - drive.body().half_length_m), 0.0)
        << "run " << run << ": " << length_m << " m long, " << under_body_m
        << " m under the body, at " << speed_mps << " m/s";
  }
}

}  // namespace narrow_hole_test
}  // namespace nodmap::navigator
