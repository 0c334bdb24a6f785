// SPDX-License-Identifier: BSD-3-Clause
// For tests: a scan of the laser of KURT3D in a world that is given by its ranges.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"
#include "common/scan/scan.hpp"

namespace nodmap::navigator::test {

/// A scan of 181 beams. `range_m(origin, ray)`: the range, in metres, of the beam that begins at
/// `origin` and goes in direction `ray`, both in odom.
template <class RangeM>
scan::Scan kurt_scan(const geometry::SE3& T_odom_base, double pitch_rad, const RangeM& range_m) {
  scan::Scan scan;
  scan.angle_first_rad = -0.5 * geometry::kPi;
  scan.angle_step_rad = geometry::deg_to_rad(1.0);
  scan.pitch_first_rad = scan.pitch_last_rad = pitch_rad;
  scan.range_min_m = 0.05;
  scan.range_max_m = 80.0;
  scan.T_base_mount.translation() = Eigen::Vector3d(0.15, 0.0, 0.38);
  const geometry::SE3 T_odom_mount = T_odom_base * scan.T_base_mount;
  for (std::size_t i = 0; i < 181; ++i) {
    const Eigen::Vector3d ray =
        T_odom_mount.linear() * scan::beam_direction(scan.angle_rad(i), pitch_rad);
    scan.ranges_m.push_back(static_cast<float>(range_m(T_odom_mount.translation(), ray)));
  }
  return scan;
}

}  // namespace nodmap::navigator::test
