// SPDX-License-Identifier: BSD-3-Clause
// How far odometry errs: two models, which agree over 0.3 m, the distance between keyframes: 7 cm
// and 2 degrees. Robots with two driven wheels err less, robots that skid more.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "common/geometry/se2.hpp"

namespace nodmap::slam2d {

/// The variances (x and y in m^2, yaw in rad^2) that a motion adds to a pose that follows odometry
/// from scan to scan. They are proportional to the path, whatever its steps: 40 cm after 10 m.
[[nodiscard]] inline Eigen::Vector3d odometry_variances(double distance_m, double rotation_rad) {
  constexpr double kPositionVarianceM2PerM = 0.016;
  constexpr double kYawVarianceRad2PerM = 0.004;
  constexpr double kYawVarianceRad2PerRad = 0.008;
  return {kPositionVarianceM2PerM * distance_m, kPositionVarianceM2PerM * distance_m,
          kYawVarianceRad2PerM * distance_m + kYawVarianceRad2PerRad * std::abs(rotation_rad)};
}

/// The information (x, y, yaw, in the frame of its start) of odometry on a step of the pose graph.
/// In a graph that spans a building the errors of wheels are systematic, not white noise, so the
/// standard deviations are proportional to the step. The numbers hold for 30 m.
[[nodiscard]] inline Eigen::Matrix3d odometry_information(const geometry::SE2& step) {
  const double distance_m = std::hypot(step.x, step.y);
  const double sigma_m = 0.01 + 0.2 * distance_m;
  const double sigma_rad = 0.02 + 0.1 * std::abs(step.yaw) + 0.05 * distance_m;
  return Eigen::Vector3d(1.0 / (sigma_m * sigma_m), 1.0 / (sigma_m * sigma_m),
                         1.0 / (sigma_rad * sigma_rad))
      .asDiagonal();
}

}  // namespace nodmap::slam2d
