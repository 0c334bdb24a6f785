// SPDX-License-Identifier: BSD-3-Clause
#include "common/geometry/se3.hpp"

namespace nodmap::geometry {

SE3 make_se3(const Eigen::Vector3d& translation, const Eigen::Quaterniond& rotation) {
  SE3 pose = SE3::Identity();
  pose.linear() = rotation.toRotationMatrix();
  pose.translation() = translation;
  return pose;
}

SE3 to_se3(const SE2& pose) {
  SE3 lifted = SE3::Identity();
  lifted.linear().topLeftCorner<2, 2>() = pose.rotation();
  lifted.translation().head<2>() = pose.translation();
  return lifted;
}

SE2 to_se2(const SE3& pose) {
  return {pose.translation().x(), pose.translation().y(),
          std::atan2(pose.linear()(1, 0), pose.linear()(0, 0))};
}

Eigen::Matrix3d pitch_rotation(double pitch_up_rad) {
  // A positive right-handed rotation about y turns x towards -z: it looks down.
  return Eigen::AngleAxisd(-pitch_up_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
}

SE3 interpolate(const SE3& from, const SE3& to, double fraction) {
  const Eigen::AngleAxisd turn(from.linear().transpose() * to.linear());
  SE3 between = SE3::Identity();
  between.linear() =
      from.linear() * Eigen::AngleAxisd(fraction * turn.angle(), turn.axis()).toRotationMatrix();
  between.translation() = from.translation() + fraction * (to.translation() - from.translation());
  return between;
}

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd angle_axis(rotation);
  return angle_axis.angle() * angle_axis.axis();
}

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& rotation_vector) {
  const double angle_rad = rotation_vector.norm();
  return angle_rad > 0.0
             ? Eigen::AngleAxisd(angle_rad, rotation_vector / angle_rad).toRotationMatrix()
             : Eigen::Matrix3d::Identity();
}

// Not in the header: Eigen would compile a singular value decomposition into each source that calls
// it.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to);
}

double rotation_angle(const SE3& pose) {
  return std::abs(Eigen::AngleAxisd(pose.linear()).angle());
}

}  // namespace nodmap::geometry
