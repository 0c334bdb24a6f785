// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/front_end/pose_covariance.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "common/registration/pose_edges.hpp"
#include "modules/slam2d/back_end/wheel_errors.hpp"

namespace nodmap::slam2d {
namespace {

// An eigenvalue of the information is zero when it is below this ratio of the largest.
constexpr double kZeroRatio = 1e-9;

// The standard deviations of the position along the axes of its error ellipse, the least first.
Eigen::Vector2d position_sigmas_m(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(
      Eigen::Matrix2d(covariance.topLeftCorner<2, 2>()), Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
}

}  // namespace

void PoseCovariance::predict(double yaw_rad, const geometry::SE2& T_before_now) {
  const Eigen::Vector2d step =
      geometry::SE2{0.0, 0.0, yaw_rad}.rotation() * T_before_now.translation();
  const Eigen::Matrix3d J = registration::moment_arm_jacobian(step);
  covariance_ = J * covariance_ * J.transpose();
  covariance_.diagonal() += odometry_variances(step.norm(), T_before_now.yaw);
}

void PoseCovariance::rotate(double yaw_rad) {
  covariance_ = registration::rotated(covariance_, yaw_rad);
}

// Standard deviations of 1 m/s and 1 rad/s: the robot may drive on, or be carried.
void PoseCovariance::lose_track(double duration_s) {
  covariance_.diagonal().array() += duration_s * duration_s;
}

// Directions that the match determines take its information. The others, the null space of the
// information, keep what was known before.
void PoseCovariance::update(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information);
  const Eigen::Vector3d& values = eigen.eigenvalues();  // increasing
  if (!(values[2] > 0.0)) {
    return;
  }
  Eigen::Matrix3d matched = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d direction = eigen.eigenvectors().col(i);
    const double variance = values[i] > kZeroRatio * values[2]
                                ? 1.0 / values[i]
                                : direction.dot(covariance_ * direction);
    matched += variance * direction * direction.transpose();
  }
  covariance_ = matched;
}

double PoseCovariance::least_sigma_m() const {
  return position_sigmas_m(covariance_)[0];
}

double PoseCovariance::greatest_sigma_m() const {
  return position_sigmas_m(covariance_)[1];
}

}  // namespace nodmap::slam2d
