// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "common/geometry/se2.hpp"
#include "drivers/kurt/gyro_heading.hpp"
#include "drivers/kurt/kurt_frames.hpp"
#include "drivers/kurt/params.hpp"

namespace nodmap::kurt {

/// The pose and motion of the robot by its wheels and its gyro, with covariance.
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
/// The gyro corrects the rotation.
class Odometry {
 public:
  Odometry(const WheelParams& wheels, const OdometryNoiseParams& noise, const GyroParams& gyro = {})
      : wheels_(wheels), noise_(noise), gyro_(gyro) {}

  /// Whether wheels can be as fast as these ticks imply, and can have become so since the last
  /// ones.
  [[nodiscard]] bool is_plausible(const EncoderTicks& ticks) const;

  /// Adds the encoder ticks of one period. Implausible ticks return false, and the period is
  /// bridged like a lost one.
  bool add(const EncoderTicks& ticks);

  /// Leaves out the period of these implausible ticks: the robot is not assumed to move in it.
  void ignore(const EncoderTicks& ticks);

  /// Takes an angle of the gyro, measured between the last encoder ticks and the next.
  void correct(const Gyro& gyro) { gyro_.add(gyro); }

  /// Bridges lost encoder frames: assumes that the robot moved on roughly as before.
  void bridge(int lost_frames);

  /// Bridges `gap_s` seconds without any information. The pose stays the same; its uncertainty
  /// grows by the distance that the robot may have rolled until the base stopped it.
  void bridge_gap(double gap_s);

  [[nodiscard]] const OdometryState& state() const { return state_; }
  [[nodiscard]] const GyroHeading& gyro() const { return gyro_; }

 private:
  /// After more periods than this without ticks to believe, two that follow from each other are as
  /// good: otherwise an odometry that once believed the wrong ones would never find back.
  static constexpr int kRemembered = 10;

  [[nodiscard]] bool can_follow(const EncoderTicks& before, const EncoderTicks& ticks,
                                int periods) const;
  [[nodiscard]] double m_per_tick() const {
    return wheels_.perimeter_m / wheels_.ticks_per_revolution;
  }

  /// What the wheels measure in a period.
  struct Motion {
    double distance_m = 0.0;
    double rotation_rad = 0.0;
    double wheel_path_m = 0.0;  ///< mean distance driven by the two sides, each positive
  };

  /// Moves the pose along an arc, by the motion of so many periods. `sigma_ratio` times distance
  /// and rotation is a standard deviation added to the wheels' own noise.
  void move(const Motion& motion, int periods, double sigma_ratio);

  WheelParams wheels_;
  OdometryNoiseParams noise_;
  GyroHeading gyro_;
  Motion last_motion_;
  EncoderTicks believed_;  // the last plausible ones
  EncoderTicks received_;  // the last ones, or {} after a gap
  int periods_since_believed_ = kRemembered;
  OdometryState state_;
};

}  // namespace nodmap::kurt
