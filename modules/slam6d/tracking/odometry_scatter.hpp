// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/slam6d/tracking/odometry_calibration.hpp"

namespace nodmap::slam6d {

/// The random error of the wheels in distance, after calibration, as a factor (at most 1) of the
/// standard deviations of OdometryParams. Learned from how far predictions were off where
/// registration determines the motion. Initially 1.
///
/// In a bare corridor only odometry determines the length of the path. Errors of normals, and
/// people who walk along, seem to determine it, too, and the more odometry may be wrong, the more
/// they count. OdometryParams must hold for any wheels, but most are far better.
class OdometryScatter {
 public:
  /// `least`: the lower limit of the factor; with 1 nothing is learned.
  explicit OdometryScatter(double least) : least_(least) {}

  /// Learns from a motion with the variance `variance_m2` by OdometryParams. The factor rises at
  /// once after slip, and falls within some 100 motions if the wheels are good.
  void learn(const MotionEvidence& forward, double variance_m2);

  /// To be called when a sweep did not fit, which may be due to slip: returns to the initial
  /// factor.
  void forget() { *this = OdometryScatter(least_); }

  /// The factor, from `least` to 1.
  [[nodiscard]] double factor() const;

 private:
  static constexpr double kAtFirst = 3.0;  // weight of OdometryParams, in motions

  double least_;
  double square_ = 1.0;  // of the factor
  double motions_ = kAtFirst;
};

}  // namespace nodmap::slam6d
