// SPDX-License-Identifier: BSD-3-Clause
// Tests that the robot stops before low sills of 3 to 4 cm, anywhere across its path and at any
// moment of the nod, with the noise of the laser and of the body's tilt.
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "modules/navigator/local_map/test/braking_drive.hpp"

namespace nodmap::navigator {
namespace low_sill_test {

using test::BrakingDrive;

// A box on the floor, rotated about its middle.
struct Sill {
  geometry::SE2 T_odom_sill;
  Eigen::Vector2d half_m;
  double height_m;

  // Range at which a ray hits the sill; +infinity if it misses.
  [[nodiscard]] double range_m(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) const {
    const geometry::SE2 T_sill_odom = T_odom_sill.inverse();
    const Eigen::Vector2d o = T_sill_odom * Eigen::Vector2d(origin.head<2>());
    const Eigen::Vector2d d = T_sill_odom.rotation() * ray.head<2>();
    const Eigen::Vector3d from(o.x(), o.y(), origin.z() - 0.5 * height_m);
    const Eigen::Vector3d along(d.x(), d.y(), ray.z());
    const Eigen::Vector3d half(half_m.x(), half_m.y(), 0.5 * height_m);
    double enters = 0.0;
    double leaves = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (-half[axis] - from[axis]) / along[axis];
      const double b = (half[axis] - from[axis]) / along[axis];
      enters = std::max(enters, std::min(a, b));
      leaves = std::min(leaves, std::max(a, b));
    }
    return enters <= leaves ? enters : std::numeric_limits<double>::infinity();
  }

  // The smallest x of the sill within `half_width_m` of the x axis, along which the body drives.
  [[nodiscard]] double begins_m(double half_width_m) const {
    double x = std::numeric_limits<double>::infinity();
    for (double u = -1.0; u <= 1.0; u += 0.004) {
      for (double v = -1.0; v <= 1.0; v += 0.05) {
        const Eigen::Vector2d p = T_odom_sill * Eigen::Vector2d(v * half_m.x(), u * half_m.y());
        if (std::abs(p.y()) <= half_width_m) {
          x = std::min(x, p.x());
        }
      }
    }
    return x;
  }
};

// Range of the half width of a sill, metres.
struct Widths {
  double least_m;
  double most_m;
};

// In eight parts, which run beside each other.
class LowSill : public ::testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(Parts, LowSill, ::testing::Range(0, 8));

// At these speeds the lines of a sweep are farther apart than cells. If each cell needed two hits,
// the robot would hit four of these sills. By heights above the ground alone it would hit 2 of 400
// sills and 14 of 400 bricks: only compared with the floor on the same line are they high enough.
TEST_P(LowSill, TheRobotStopsBeforeItAtAnySpeedAndMomentOfTheNod) {
  std::mt19937 engine(1);
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution(a, b)(engine);
  };
  for (int run = 0; run < 96; ++run) {
    const Widths widths = run < 64 ? Widths{0.1, 1.5} : Widths{0.03, 0.1};
    const double speed_mps = between(1.0, 1.5);
    const double yaw_rad = between(-0.5, 0.5);
    const double half_width_m = between(widths.least_m, widths.most_m);
    // It covers at least 8 cm of the body's width.
    const double aside_m = between(0.0, half_width_m + 0.085) * (run % 2 == 0 ? 1.0 : -1.0);
    const double x_m = between(2.5, 4.0);
    const double half_depth_m = 0.5 * between(0.02, 0.25);
    const double height_m = between(0.03, 0.04);
    const Sill sill{{x_m, aside_m, yaw_rad}, {half_depth_m, half_width_m}, height_m};
    if (run % 8 != GetParam()) {
      continue;
    }
    BrakingDrive drive(
        [&](const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
          const double floor_m = ray.z() < 0.0 ? -origin.z() / ray.z() : 1e9;
          return std::min(floor_m, sill.range_m(origin, ray));
        },
        speed_mps, static_cast<std::uint32_t>(run));
    const robot::Footprint& body = drive.body();
    EXPECT_GT(drive.until(sill.begins_m(body.half_width_m) - body.half_length_m), 0.0)
        << "run " << run << ": " << height_m << " m high, at " << speed_mps << " m/s";
  }
}

}  // namespace low_sill_test
}  // namespace nodmap::navigator
