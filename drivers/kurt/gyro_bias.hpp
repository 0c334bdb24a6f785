// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/kurt/params.hpp"

namespace nodmap::kurt {

/// The yaw rate that the gyro reports of a stationary robot, measured while the wheels are still.
class GyroBias {
 public:
  enum class Result : std::uint8_t {
    kNothing,
    kMeasured,
    kRunsOff,  ///< larger than that of any intact gyro; then there is none
  };

  explicit GyroBias(const GyroParams& params) : params_(params) {}

  /// Adds what the gyro has rotated in a time in which the wheels were still.
  Result add_still(double gyro_rad, double dt_s);
  /// The wheels are no longer still, or the gyro is silent.
  void end_standstill();
  /// Time passes, in which the bias changes.
  void age(double dt_s);

  /// Empty until it has been measured.
  [[nodiscard]] std::optional<double> rate_rad_s() const;
  /// By how much the variance of a heading grows in a second because of the bias, rad^2/s; only
  /// once it has been measured.
  [[nodiscard]] double variance_rad2_per_s() const;

 private:
  struct Estimate {
    double rate_rad_s = 0.0;
    double variance_rad2_s2 = 0.0;  // when it was measured
    double age_s = 0.0;             // since then
  };

  [[nodiscard]] Result take(double rate_rad_s, double dt_s);

  GyroParams params_;
  std::optional<Estimate> estimate_;
  double window_rad_ = 0.0;  // in the present standstill
  double window_s_ = 0.0;
  double odd_rate_rad_s_ = 0.0;  // a rate that is not that of the bias
  int odd_windows_ = 0;          // for so many windows in a row
};

}  // namespace nodmap::kurt
