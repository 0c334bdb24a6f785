// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/fan.hpp"

#include <cmath>

namespace nodmap::navigator {

bool Fan::take(const scan::Scan& scan) {
  const std::size_t n = scan.ranges_m.size();
  if (directions_.size() == n && first_rad_ == scan.angle_first_rad &&
      step_rad_ == scan.angle_step_rad) {
    return false;
  }
  first_rad_ = scan.angle_first_rad;
  step_rad_ = scan.angle_step_rad;
  directions_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    directions_[i] = {std::cos(scan.angle_rad(i)), std::sin(scan.angle_rad(i))};
  }
  return true;
}

Beam Fan::beam(const scan::Scan& scan, std::size_t i, const geometry::SE3& T_odom_mount) const {
  const double pitch_rad = scan.pitch_rad(i);
  const double c = std::cos(pitch_rad);
  const double s = std::sin(pitch_rad);
  const Eigen::Vector3d& mirror = scan.mirror_offset_m;
  const Eigen::Vector2d& direction = directions_[i];
  return {
      T_odom_mount * Eigen::Vector3d(c * mirror.x() - s * mirror.z(), mirror.y(),
                                     s * mirror.x() + c * mirror.z()),
      T_odom_mount.linear() * Eigen::Vector3d(c * direction.x(), direction.y(), s * direction.x()),
      static_cast<double>(scan.ranges_m[i]), scan.is_hit(i)};
}

}  // namespace nodmap::navigator
