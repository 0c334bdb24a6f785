// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/slam6d/odometry_calibration.hpp"

namespace nodmap::slam6d {

/// How far the wheels scatter in the distance that they count, beside what calibration puts right:
/// the part of the standard deviation of OdometryParams that is left, learned from how far
/// predictions were off where registration knew better. At first 1.
///
/// In a bare corridor no scene says how long the way was, and odometry alone holds it. Errors of
/// normals and people who walk along seem to say something, and are believed as far as odometry
/// may be wrong. OdometryParams must do for any wheels; most are better by far.
class OdometryScatter {
 public:
  /// `least`: never less than this, 1: nothing is learned.
  explicit OdometryScatter(double least) : least_(least) {}

  /// Learns from a motion whose variance, as OdometryParams has it, is `variance_m2`. Slip is
  /// believed at once, good wheels after some 100 motions.
  void learn(const MotionEvidence& forward, double variance_m2);

  /// A sweep did not fit, which may be slip: the wheels are believed no more than at first.
  void forget() { *this = OdometryScatter(least_); }

  /// `least` to 1.
  [[nodiscard]] double factor() const;

 private:
  static constexpr double kAtFirst = 3.0;  // motions that OdometryParams counts for

  double least_;
  double square_ = 1.0;  // of the factor
  double motions_ = kAtFirst;
};

}  // namespace nodmap::slam6d
