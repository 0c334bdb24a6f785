// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "common/geometry/se2.hpp"
#include "drivers/kurt/kurt_frames.hpp"
#include "drivers/kurt/params.hpp"

namespace nodmap::kurt {

/// The pose and motion of the robot by its wheels, with covariance.
struct OdometryState {
  geometry::SE2 T_odom_base;
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;  ///< positive turns left
  /// Covariance of x (m), y (m), yaw (rad) in odom. Grows from zero.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Odometry of a skid-steered robot. The three wheels of a side are coupled, so they slip sideways
/// when the robot rotates, and it rotates by less than the difference of the wheels implies;
/// turning_adaptation calibrates by how much. Formulas of uos/kurt_driver, in a right-handed frame.
class Odometry {
 public:
  Odometry(const WheelParams& wheels, const OdometryNoiseParams& noise)
      : wheels_(wheels), noise_(noise) {}

  /// Whether wheels can be as fast as these ticks imply.
  [[nodiscard]] bool is_plausible(const EncoderTicks& ticks) const;

  /// Adds the encoder ticks of one period. Implausible ticks return false, and the period is
  /// bridged like a lost one.
  bool add(const EncoderTicks& ticks);

  /// Bridges lost encoder frames: assumes that the robot moved on roughly as before.
  void bridge(int lost_frames);

  /// Bridges `gap_s` seconds without any information. The pose stays the same; its uncertainty
  /// grows by the distance that the robot may have rolled until the base stopped it.
  void bridge_gap(double gap_s);

  [[nodiscard]] const OdometryState& state() const { return state_; }

 private:
  [[nodiscard]] double m_per_tick() const {
    return wheels_.perimeter_m / wheels_.ticks_per_revolution;
  }

  /// Moves the pose along an arc. `sigma_ratio` times distance and rotation is a standard deviation
  /// added to the wheels' own noise.
  void move(double distance_m, double rotation_rad, double sigma_ratio);

  WheelParams wheels_;
  OdometryNoiseParams noise_;
  OdometryState state_;
};

}  // namespace nodmap::kurt
