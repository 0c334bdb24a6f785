// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

#include "common/geometry/angle.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::sim {

/// The errors of a MEMS gyro, without correction. The sources and reasons of the values are in
/// sim/README.md.
struct YawGyroParams {
  double bias_rad_s = geometry::deg_to_rad(0.3);
  double bias_walk_rad_s = geometry::deg_to_rad(0.003);
  double random_walk_rad = geometry::deg_to_rad(0.07);
  double noise_rad = geometry::deg_to_rad(0.02);
  double scale_error = 0.005;

  template <class Visitor>
  void describe(Visitor& v) {
    v.angle("gyro_bias_deg_s", bias_rad_s, {-10.0, 10.0},
            "Yaw rate that the gyro reports of a stationary robot when it is switched on.");
    v.angle("gyro_bias_walk_deg_s", bias_walk_rad_s, {0.0, 1.0},
            "Standard deviation of this rate's change in 1 s; grows with the root of the time.");
    v.angle("gyro_random_walk_deg", random_walk_rad, {0.0, 10.0},
            "Standard deviation of the gyro's angle after 1 s, by the noise of its rate; grows "
            "with the root of the time.");
    v.angle("gyro_noise_deg", noise_rad, {0.0, 10.0},
            "Standard deviation of each yaw angle of the gyro, independent of the others.");
    v.number("gyro_scale_error", scale_error, {-0.5, 0.5},
             "Relative excess of the rotations that the gyro measures.");
  }
};

/// A gyro that measures the rotation about the robot's own upright axis, and a controller that
/// integrates it to an angle.
class YawGyro {
 public:
  YawGyro(const YawGyroParams& params, const Eigen::Matrix3d& R_world_base, time::SteadyTime now,
          std::uint64_t seed);

  /// Makes the present angle zero.
  void reset() { angle_rad_ = 0.0; }

  /// The angle, in (-pi, pi], of a robot that has rotated to R_world_base since the last call. To
  /// be called several times a second.
  [[nodiscard]] double read(const Eigen::Matrix3d& R_world_base, time::SteadyTime now);

 private:
  YawGyroParams params_;
  Eigen::Matrix3d R_world_base_;
  time::SteadyTime now_;
  double angle_rad_ = 0.0;
  double bias_rad_s_;
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

}  // namespace nodmap::sim
