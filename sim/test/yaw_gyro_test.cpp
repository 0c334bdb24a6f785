// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/yaw_gyro.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "sim/test/host.hpp"

namespace nodmap::sim {
namespace yaw_gyro_test {

using geometry::deg_to_rad;
using geometry::rad_to_deg;
using test::at;

YawGyroParams exact() {
  return {.bias_rad_s = 0.0,
          .bias_walk_rad_s = 0.0,
          .random_walk_rad = 0.0,
          .noise_rad = 0.0,
          .scale_error = 0.0};
}

Eigen::Matrix3d upright(double yaw_rad) {
  return Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

TEST(YawGyro, AnExactOneIsTheHeadingAndWraps) {
  YawGyro gyro(exact(), upright(0.0), at(0ms), 1);
  for (int i = 1; i <= 100; ++i) {
    EXPECT_NEAR(gyro.read(upright(0.1 * i), at(i * 70ms)), geometry::normalize_angle(0.1 * i),
                1e-9);
  }
  gyro.reset();
  EXPECT_NEAR(gyro.read(upright(10.2), at(7070ms)), 0.2, 1e-9);
}

TEST(YawGyro, ItsScaleMultipliesRotations) {
  YawGyroParams params = exact();
  params.scale_error = 0.01;
  YawGyro gyro(params, upright(0.0), at(0ms), 1);
  EXPECT_NEAR(gyro.read(upright(1.0), at(70ms)), 1.01, 1e-9);
}

// On a slope the body rotates about its own upright axis by the cosine of the slope less than seen
// from above, when it turns across the slope.
TEST(YawGyro, ItMeasuresTheRotationAboutTheBodysAxis) {
  const Eigen::Matrix3d tilt =
      Eigen::AngleAxisd(deg_to_rad(-10.0), Eigen::Vector3d::UnitY()).toRotationMatrix();
  YawGyro gyro(exact(), tilt, at(0ms), 1);
  double angle_rad = 0.0;
  for (int i = 1; i <= 100; ++i) {
    angle_rad = gyro.read(upright(0.01 * i) * tilt, at(i * 70ms));
  }
  // Steps of 0.6 degrees: the error of their rotation vectors is of third order.
  EXPECT_NEAR(angle_rad, std::cos(deg_to_rad(10.0)), 1e-4);
}

TEST(YawGyro, ItsErrorsGrowAsStated) {
  const YawGyroParams params{.scale_error = 0.0};
  constexpr int kGyros = 1000;
  constexpr int kSeconds = 100;
  double sum_rad = 0.0;
  double sum_sq = 0.0;
  for (int seed = 0; seed < kGyros; ++seed) {
    YawGyro gyro(params, upright(0.0), at(0ms), static_cast<std::uint64_t>(seed));
    double angle_rad = 0.0;
    for (int s = 1; s <= kSeconds; ++s) {
      angle_rad = gyro.read(upright(0.0), at(s * 1s));
    }
    const double error_rad = angle_rad - kSeconds * params.bias_rad_s;
    sum_rad += error_rad;
    sum_sq += error_rad * error_rad;
  }
  const double walk = params.bias_walk_rad_s * std::sqrt(std::pow(kSeconds, 3) / 3.0);
  const double sigma_rad = std::hypot(params.random_walk_rad * std::sqrt(kSeconds), walk);
  // 1000 samples: the deviation is known to 2.2 %, the mean to 3.2 % of it; four times that.
  EXPECT_NEAR(std::sqrt(sum_sq / kGyros) / sigma_rad, 1.0, 0.09);
  EXPECT_NEAR(sum_rad / kGyros / sigma_rad, 0.0, 0.13);
}

}  // namespace yaw_gyro_test
}  // namespace nodmap::sim
