// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/odometry_calibration.hpp"

#include <gtest/gtest.h>

#include <random>

namespace nodmap::slam6d {
namespace odometry_calibration_test {

using geometry::deg_to_rad;
using geometry::SE3;

// The motion along an arc of constant curvature.
SE3 arc(double length_m, double rotation_rad) {
  const double curvature = rotation_rad / length_m;
  SE3 motion = SE3::Identity();
  motion.translation() << std::sin(rotation_rad) / curvature,
      (1.0 - std::cos(rotation_rad)) / curvature, 0.0;
  motion.linear() = geometry::rotation_of({0.0, 0.0, rotation_rad});
  return motion;
}

// What odometry reports for the motion along an arc, if the wheels count 4 % too much distance and
// 6 % too much rotation, and in addition 0.5 degrees a metre.
SE3 counted(double length_m, double rotation_rad) {
  return arc(1.04 * length_m, 1.06 * rotation_rad + deg_to_rad(0.5) * length_m);
}

MotionEvidence evidence(double deviation, double sigma) {
  return {.deviation = deviation,
          .prior_variance = 1.0,
          .posterior_variance = sigma * sigma,
          .random_variance = sigma * sigma};
}

// From 100 motions of 0.5 m, measured to 5 mm and 0.2 degrees, the errors are known to about 0.1 %
// (0.005 / 0.5 / 10) and 0.12 % (0.2 deg / 0.3 rad / 10). The tolerance is three times that.
TEST(OdometryCalibration, LearnsTheErrorsOfTheWheels) {
  OdometryCalibration calibration({});
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::uniform_real_distribution<double> rotation(-0.5, 0.5);
  for (int i = 0; i < 100; ++i) {
    const double rotation_rad = rotation(random);
    const SE3 motion = counted(0.5, rotation_rad);
    const SE3 deviation = calibration.calibrate(motion).inverse() * arc(0.5, rotation_rad);
    calibration.learn(motion, evidence(deviation.translation().x() + 0.005 * noise(random), 0.005),
                      evidence(geometry::rotation_vector(deviation.linear()).z() +
                                   deg_to_rad(0.2) * noise(random),
                               deg_to_rad(0.2)));
  }
  EXPECT_NEAR(calibration.errors()[0], 1.0 / 1.04 - 1.0, 0.004);
  EXPECT_NEAR(calibration.errors()[1], 1.0 / 1.06 - 1.0, 0.004);
  const SE3 error = calibration.calibrate(counted(1.0, 1.0)).inverse() * arc(1.0, 1.0);
  EXPECT_LT(error.translation().norm(), 0.01);
  EXPECT_LT(geometry::rotation_angle(error), deg_to_rad(0.5));
}

// Nothing is learned from a slip of 30 degrees, from a prediction that registration did not
// improve, from a stationary robot, or if the prior's standard deviations are zero.
TEST(OdometryCalibration, UninformativeMotionsChangeNothing) {
  OdometryCalibration calibration({});
  calibration.learn(arc(0.5, 0.1), {}, evidence(deg_to_rad(30.0), deg_to_rad(0.2)));
  EXPECT_TRUE(calibration.errors().isZero(0.0));
  const MotionEvidence none{.deviation = 0.1, .prior_variance = 1.0, .posterior_variance = 0.95};
  calibration.learn(arc(0.5, 0.1), none, none);
  calibration.learn(SE3::Identity(), evidence(0.002, 0.005), evidence(0.002, 0.005));
  EXPECT_TRUE(calibration.errors().isZero(0.0));
  EXPECT_EQ(calibration.calibrate(arc(0.5, 0.1)).matrix(), arc(0.5, 0.1).matrix());

  OdometryCalibration fixed(
      {.translation_scale = 0.0, .rotation_scale = 0.0, .yaw_rad_per_m = 0.0});
  fixed.learn(arc(0.5, 0.1), evidence(0.01, 0.005), evidence(0.01, 0.005));
  EXPECT_TRUE(fixed.errors().isZero(0.0));
}

}  // namespace odometry_calibration_test
}  // namespace nodmap::slam6d
