// SPDX-License-Identifier: BSD-3-Clause
// Evidence about a pose that loses weight the more the sweep contradicts it.
#pragma once

#include <Eigen/Geometry>

#include "common/geometry/se3.hpp"
#include "common/registration/motion_solver.hpp"
#include "modules/slam6d/registration.hpp"

namespace nodmap::slam6d {

/// The weight of a residual by the Geman-McClure kernel: 1 at zero, 1/4 at the scale of the kernel.
/// `relative_sq`: the square of the residual divided by that scale.
template <class Scalar>
[[nodiscard]] Scalar geman_mcclure(Scalar relative_sq) {
  const Scalar root = Scalar(1) / (Scalar(1) + relative_sq);
  return root * root;
}

/// The information of a deviation with standard deviation `sigma`, by a kernel whose scale is
/// `kernel` standard deviations.
[[nodiscard]] inline double robust_information(double deviation, double sigma, double kernel) {
  const double relative = deviation / (kernel * sigma);
  return geman_mcclure(relative * relative) / (sigma * sigma);
}

/// Evidence that the ground is level, about the motion from a pose to where the base has this
/// height, no roll and no pitch.
[[nodiscard]] inline registration::Information<6> level_evidence(const PosePrior::Level& level,
                                                                 const geometry::SE3& T_map_base) {
  // From the base's z axis to that of map.
  const Eigen::Vector3d tilt = T_map_base.linear().col(2).cross(Eigen::Vector3d::UnitZ());
  registration::Information<6> evidence;
  const auto add = [&evidence](int i, double deviation, double sigma) {
    const double information = robust_information(deviation, sigma, kLevelKernel);
    evidence.H(i, i) = information;
    evidence.b(i) = information * deviation;
  };
  add(2, level.height_m - T_map_base.translation().z(), level.height_sigma_m);
  add(3, tilt.x(), level.tilt_sigma_rad);
  add(4, tilt.y(), level.tilt_sigma_rad);
  return evidence;
}

}  // namespace nodmap::slam6d
