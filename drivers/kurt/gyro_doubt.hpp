// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::kurt {

/// Doubt about the gyro: whether it rotates in a way that no slip of the wheels explains, because
/// it has jumped, was zeroed or has the wrong sign.
class GyroDoubt {
 public:
  /// What both measured between two angles of the gyro.
  struct Rotations {
    double gyro_rad = 0.0;    ///< without the bias
    double wheels_rad = 0.0;  ///< by the difference of the sides
    double path_m = 0.0;      ///< mean distance driven by the two sides, each positive
  };

  /// Compares the rotations of `dt_s` seconds, alone and summed over about a second.
  void add(const Rotations& rotations, double dt_s);

  /// Forgets the sums, because the robot has been stationary since.
  void forget_sums() { sums_ = {}; }

  [[nodiscard]] bool is_active() const { return is_active_; }

 private:
  void update(const Rotations& rotations, bool is_plausible);

  Rotations sums_;
  bool is_active_ = false;
  double agreed_rad_ = 0.0;  // by so much the gyro has followed the wheels since it was doubted
};

}  // namespace nodmap::kurt
