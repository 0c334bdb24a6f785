// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"

namespace nodmap::slam6d {

/// Nothing is learned from a sweep that reduces the variance of a prediction by no more than this
/// ratio.
inline constexpr double kMinGain = 0.1;

/// How large the constant errors of the wheels may be, as standard deviations (0: not learned), and
/// the lower limit of the random error that is learned.
struct CalibrationParams {
  double translation_scale = 0.05;
  double rotation_scale = 0.05;
  double yaw_rad_per_m = geometry::deg_to_rad(1.0);
  double min_scatter = 0.2;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("translation_scale", translation_scale, {0.0, 1.0},
             "Standard deviation of the constant relative error of odometry in distance, which is "
             "learned; 0: not learned.");
    v.number("rotation_scale", rotation_scale, {0.0, 1.0},
             "The same for rotations: a wrong track width.");
    v.angle("yaw_per_m_deg", yaw_rad_per_m, {0.0, 90.0},
            "Standard deviation of the constant error of the heading per metre, which is learned: "
            "unequal wheels.");
    v.number("min_scatter", min_scatter, {0.01, 1.0},
             "Smallest ratio to which odometry.translation_* are reduced if the wheels prove to be "
             "better; 1: not learned.");
  }
};

/// What registration finds in one direction of a motion that odometry predicted.
struct MotionEvidence {
  double deviation = 0.0;           ///< of the estimate from the prediction
  double prior_variance = 0.0;      ///< of the prediction on which the estimate is based
  double posterior_variance = 0.0;  ///< of the estimate
  double start_variance = 0.0;      ///< of the pose at which the motion began
  double random_variance = 0.0;     ///< of odometry, without its constant errors
};

/// The constant errors of wheels, in distance, in rotation and in heading per metre, learned by a
/// Kalman filter from motions whose true size registration measures.
class OdometryCalibration {
 public:
  explicit OdometryCalibration(const CalibrationParams& params);

  /// Corrects a motion of a few seconds, as odometry counted it.
  [[nodiscard]] geometry::SE3 calibrate(const geometry::SE3& motion) const;

  /// Learns from the motion `motion`, as odometry counted it.
  void learn(const geometry::SE3& motion, const MotionEvidence& forward, const MotionEvidence& yaw);

  /// The corrections: per metre of distance, per radian of rotation, and of heading (rad) per
  /// metre.
  [[nodiscard]] const Eigen::Vector3d& errors() const { return errors_; }

 private:
  void update(const Eigen::Vector3d& motion, const MotionEvidence& evidence);

  Eigen::Vector3d errors_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_;
};

}  // namespace nodmap::slam6d
