// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"

namespace nodmap::slam6d {

/// A prediction whose variance the sweep made less by no more than this part tells nothing.
inline constexpr double kMinGain = 0.1;

/// How far the wheels may be off what they count, before anything is learned: one standard
/// deviation. 0: nothing is learned. And how good they may prove to be.
struct CalibrationParams {
  double translation_scale = 0.05;
  double rotation_scale = 0.05;
  double yaw_rad_per_m = geometry::deg_to_rad(1.0);
  double least_scatter = 0.2;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("translation_scale", translation_scale, {0.0, 1.0},
             "Constant relative error of odometry's distances, learned along; 0: none.");
    v.number("rotation_scale", rotation_scale, {0.0, 1.0},
             "The same of its rotations: a wrong track.");
    v.angle("yaw_per_m_deg", yaw_rad_per_m, {0.0, 90.0},
            "Constant error of the heading for each metre, learned along: unequal wheels.");
    v.number("least_scatter", least_scatter, {0.01, 1.0},
             "Where wheels prove better than odometry.translation_* say, their error is learned "
             "along, down to this part of it; 1: it is not.");
  }
};

/// What registration says of one direction of a motion that odometry predicted.
struct MotionEvidence {
  double deviation = 0.0;           ///< of the estimate from the prediction
  double prior_variance = 0.0;      ///< of the prediction, by which the estimate was made
  double posterior_variance = 0.0;  ///< of the estimate
  double start_variance = 0.0;      ///< of where the motion began
  double random_variance = 0.0;     ///< of odometry, without what is constant
};

/// The constant errors of wheels: distances, rotations and the heading for each metre. A Kalman
/// filter over motions whose true size registration tells.
class OdometryCalibration {
 public:
  explicit OdometryCalibration(const CalibrationParams& params);

  /// A motion within some seconds, as odometry counted it, put right.
  [[nodiscard]] geometry::SE3 calibrate(const geometry::SE3& motion) const;

  /// Learns from the motion `motion`, as odometry counted it.
  void learn(const geometry::SE3& motion, const MotionEvidence& forward, const MotionEvidence& yaw);

  /// What is added: per metre of distance, per radian of rotation, and of heading (rad) per metre.
  [[nodiscard]] const Eigen::Vector3d& errors() const { return errors_; }

 private:
  void update(const Eigen::Vector3d& motion, const MotionEvidence& evidence);

  Eigen::Vector3d errors_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_;
};

}  // namespace nodmap::slam6d
