// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "common/geometry/se2.hpp"
#include "drivers/kurt/kurt_frames.hpp"
#include "drivers/kurt/params.hpp"

namespace nodmap::kurt {

/// Where the robot is by its wheels, and how sure that is.
struct OdometryState {
  geometry::SE2 T_odom_base;
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;  ///< positive turns left
  /// Of x (m), y (m), yaw (rad) in odom. Grows from zero.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Odometry of a skid-steered robot. The three wheels of a side are coupled, so they slip sideways
/// when the robot rotates, and it rotates by less than the wheels' difference says; by how much is
/// calibrated (turning_adaptation). Formulas of uos/kurt_driver, in a right-handed frame.
class Odometry {
 public:
  Odometry(const WheelParams& wheels, const OdometryNoiseParams& noise)
      : wheels_(wheels), noise_(noise) {}

  /// Whether wheels can be so fast.
  [[nodiscard]] bool is_plausible(const EncoderTicks& ticks) const;

  /// The encoder ticks of one period. False, and the period is bridged as if lost, when they are
  /// not plausible.
  bool add(const EncoderTicks& ticks);

  /// Encoder frames got lost: the robot drove on as it did, more or less.
  void bridge(int lost_frames);

  /// For `gap_s` nothing is known. The pose stays, and becomes uncertain by the distance that the
  /// robot may have rolled until the base stopped it.
  void bridge_gap(double gap_s);

  [[nodiscard]] const OdometryState& state() const { return state_; }

 private:
  [[nodiscard]] double m_per_tick() const {
    return wheels_.perimeter_m / wheels_.ticks_per_revolution;
  }

  /// Drives an arc. `sigma_ratio` times distance and rotation is the standard deviation that comes
  /// on top of the wheels' own noise.
  void move(double distance_m, double rotation_rad, double sigma_ratio);

  WheelParams wheels_;
  OdometryNoiseParams noise_;
  OdometryState state_;
};

}  // namespace nodmap::kurt
