// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "common/geometry/se3.hpp"
#include "common/registration/motion_solver.hpp"
#include "common/registration/robust_kernel.hpp"
#include "modules/slam6d/registration/registration.hpp"

namespace nodmap::slam6d {

/// Evidence that the ground is level, about the motion from a pose to where the base has this
/// height, no roll and no pitch.
[[nodiscard]] inline registration::Information<6> level_evidence(const PosePrior::Level& level,
                                                                 const geometry::SE3& T_map_base) {
  // From the base's z axis to that of map.
  const Eigen::Vector3d tilt = T_map_base.linear().col(2).cross(Eigen::Vector3d::UnitZ());
  registration::Information<6> evidence;
  const auto add = [&evidence](int i, double deviation, double sigma) {
    const double information = registration::robust_information(deviation, sigma, kLevelKernel);
    evidence.H(i, i) = information;
    evidence.b(i) = information * deviation;
  };
  add(2, level.height_m - T_map_base.translation().z(), level.ground.height_sigma_m);
  add(3, tilt.x(), level.ground.tilt_sigma_rad);
  add(4, tilt.y(), level.ground.tilt_sigma_rad);
  return evidence;
}

}  // namespace nodmap::slam6d
