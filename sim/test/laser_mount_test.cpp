// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "sim/body/robot_model.hpp"
#include "sim/test/host.hpp"
#include "sim/test/wall_ahead.hpp"

namespace nodmap::sim {
namespace laser_mount_test {

using geometry::deg_to_rad;
using test::at;
using test::wall_ahead;

// Level ground and ranges without noise.
RobotModelParams exact_params() {
  RobotModelParams params;
  params.laser.range_sigma_m = 0.0;
  params.drive.ground_tilt_rad = 0.0;
  return params;
}

// The mirror goes round with the head: up moves it back when the laser looks up.
TEST(LaserMount, RangesAreMeasuredFromTheMirror) {
  RobotModelParams params = exact_params();
  params.servo.mirror_forward_m = 0.04;
  params.servo.mirror_up_m = 0.03;
  RobotModel model(wall_ahead(3.0), params, 1);
  model.advance_to(at(100ms));
  EXPECT_NEAR(model.measure(0.0, at(100ms)).range_m, 2.81, 7e-6);
  model.set_pitch_goal({deg_to_rad(20.0), 0.0, 0.0});
  model.advance_to(at(1s));
  const double cosine = std::cos(deg_to_rad(20.0));
  const double ahead_m = 2.85 - 0.04 * cosine + 0.03 * std::sin(deg_to_rad(20.0));
  // The mean over an oblique spot is longer: 1.25 times the measured error.
  EXPECT_NEAR(model.measure(0.0, at(1s)).range_m, ahead_m / cosine, 5e-5);
}

// A laser that is screwed on askew: yaw turns the scan, roll raises its left half, and the floor
// comes into view on the right.
TEST(LaserMount, ALaserMayBeAskewOnItsHead) {
  RobotModelParams params = exact_params();
  params.servo.laser_yaw_rad = deg_to_rad(5.0);
  RobotModel turned(wall_ahead(3.0), params, 1);
  turned.advance_to(at(100ms));
  // The tolerances are those of the same ranges without yaw (robot_model_test).
  EXPECT_NEAR(turned.measure(deg_to_rad(-5.0), at(100ms)).range_m, 2.85, 7e-6);
  EXPECT_NEAR(turned.measure(deg_to_rad(55.0), at(100ms)).range_m, 5.7, 8.8e-5);

  params.servo.laser_yaw_rad = 0.0;
  params.servo.laser_roll_rad = deg_to_rad(10.0);
  RobotModel rolled(World{}, params, 1);
  rolled.advance_to(at(100ms));
  EXPECT_EQ(rolled.measure(deg_to_rad(90.0), at(100ms)).kind, Echo::Kind::kNothing);
  // The range is the mean over a long spot: 1.25 times the measured error.
  EXPECT_NEAR(rolled.measure(deg_to_rad(-90.0), at(100ms)).range_m,
              0.38 / std::sin(deg_to_rad(10.0)), 8.4e-4);
}

}  // namespace laser_mount_test
}  // namespace nodmap::sim
