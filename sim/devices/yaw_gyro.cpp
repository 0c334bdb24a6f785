// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/yaw_gyro.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace nodmap::sim {

YawGyro::YawGyro(const YawGyroParams& params, const Eigen::Matrix3d& R_world_base,
                 time::SteadyTime now, std::uint64_t seed)
    : params_(params),
      R_world_base_(R_world_base),
      now_(now),
      bias_rad_s_(params.bias_rad_s),
      engine_(seed) {}

double YawGyro::read(const Eigen::Matrix3d& R_world_base, time::SteadyTime now) {
  const double dt_s = time::seconds(now - now_);
  const Eigen::AngleAxisd rotation(R_world_base_.transpose() * R_world_base);
  R_world_base_ = R_world_base;
  now_ = now;
  angle_rad_ += (1.0 + params_.scale_error) * rotation.angle() * rotation.axis().z() +
                bias_rad_s_ * dt_s + params_.random_walk_rad * std::sqrt(dt_s) * normal_(engine_);
  bias_rad_s_ += params_.bias_walk_rad_s * std::sqrt(dt_s) * normal_(engine_);
  return geometry::normalize_angle(angle_rad_ + params_.noise_rad * normal_(engine_));
}

}  // namespace nodmap::sim
