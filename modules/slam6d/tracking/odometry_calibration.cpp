// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/odometry_calibration.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// A deviation beyond this many standard deviations is slip or a wrong match, not calibration.
constexpr double kMaxDeviations = 3.0;

}  // namespace

OdometryCalibration::OdometryCalibration(const CalibrationParams& params)
    : covariance_(
          Eigen::Vector3d(params.translation_scale, params.rotation_scale, params.yaw_rad_per_m)
              .cwiseAbs2()
              .asDiagonal()) {}

SE3 OdometryCalibration::calibrate(const SE3& motion) const {
  if (errors_.isZero(0.0)) {
    return motion;
  }
  Eigen::Vector3d added = errors_[1] * geometry::rotation_vector(motion.linear());
  added.z() += errors_[2] * motion.translation().x();
  SE3 calibrated = SE3::Identity();
  calibrated.linear() = geometry::rotation_of(added) * motion.linear();
  // The chord of an arc rotates by half of the rotation along the arc.
  calibrated.translation() =
      (1.0 + errors_[0]) * (geometry::rotation_of(0.5 * added) * motion.translation());
  return calibrated;
}

void OdometryCalibration::learn(const SE3& motion, const MotionEvidence& forward,
                                const MotionEvidence& yaw) {
  const double distance_m = motion.translation().x();
  update({distance_m, 0.0, 0.0}, forward);
  update({0.0, geometry::rotation_vector(motion.linear()).z(), distance_m}, yaw);
}

void OdometryCalibration::update(const Eigen::Vector3d& motion, const MotionEvidence& evidence) {
  const double gain =
      (evidence.prior_variance - evidence.posterior_variance) / evidence.prior_variance;
  if (!(gain > kMinGain)) {
    return;
  }
  // The estimate is a weighted mean of prediction and measurement. This recovers the measurement.
  const double deviation = evidence.deviation / gain;
  const double variance =
      evidence.posterior_variance / gain + evidence.start_variance + evidence.random_variance;
  const Eigen::Vector3d column = covariance_ * motion;
  const double innovation_variance = motion.dot(column) + variance;
  if (!(deviation * deviation < kMaxDeviations * kMaxDeviations * innovation_variance)) {
    return;
  }
  errors_ += column * (deviation / innovation_variance);
  covariance_ -= column * column.transpose() / innovation_variance;
}

}  // namespace nodmap::slam6d
