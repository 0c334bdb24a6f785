// SPDX-License-Identifier: BSD-3-Clause
#include "common/scan/scan.hpp"

#include <cmath>

namespace nodmap::scan {

bool is_plausible(const Scan& scan) {
  const auto within = [](double value, double limit) { return std::abs(value) <= limit; };
  const auto is_on_robot = [](const Eigen::Vector3d& p) {
    return p.allFinite() && p.cwiseAbs().maxCoeff() <= kFarthestMirrorM;
  };
  return within(scan.angle_first_rad, 2 * geometry::kPi) &&
         within(scan.angle_step_rad, geometry::kPi) && scan.angle_step_rad != 0.0 &&
         within(scan.pitch_first_rad, geometry::kPi) &&
         within(scan.pitch_last_rad, geometry::kPi) && scan.range_min_m >= 0.0 &&
         within(scan.range_max_m, kFarthestRangeM) && scan.range_max_m > scan.range_min_m &&
         scan.duration >= 0us && scan.T_base_mount.matrix().allFinite() &&
         is_on_robot(scan.T_base_mount.translation()) && is_on_robot(scan.mirror_offset_m);
}

Eigen::Vector3d beam_direction(double angle_rad, double pitch_rad) {
  const double ahead = std::cos(angle_rad);
  return {ahead * std::cos(pitch_rad), std::sin(angle_rad), ahead * std::sin(pitch_rad)};
}

Eigen::Vector3d point_in_base(const Scan& scan, std::size_t beam, double range_m) {
  const double pitch = scan.pitch_rad(beam);
  return scan.T_base_mount * (geometry::pitch_rotation(pitch) * scan.mirror_offset_m +
                              range_m * beam_direction(scan.angle_rad(beam), pitch));
}

void ScanProjector::prepare_fan(const Scan& scan) {
  if (fan_.size() == scan.ranges_m.size() && angle_first_rad_ == scan.angle_first_rad &&
      angle_step_rad_ == scan.angle_step_rad) {
    return;
  }
  angle_first_rad_ = scan.angle_first_rad;
  angle_step_rad_ = scan.angle_step_rad;
  fan_.resize(scan.ranges_m.size());
  for (std::size_t i = 0; i < fan_.size(); ++i) {
    fan_[i] = {std::cos(scan.angle_rad(i)), std::sin(scan.angle_rad(i))};
  }
  points_.reserve(fan_.size());
}

std::span<const ScanProjector::Point> ScanProjector::hits(const Scan& scan) {
  prepare_fan(scan);
  points_.clear();
  const std::size_t n = scan.ranges_m.size();
  // The pitch changes at a constant rate during the scan: rotate the laser plane's forward axis by
  // a constant small angle from beam to beam instead of calling cos and sin for each.
  const double step =
      n < 2 ? 0.0 : (scan.pitch_last_rad - scan.pitch_first_rad) / static_cast<double>(n - 1);
  const double c_step = std::cos(step);
  const double s_step = std::sin(step);
  double c = std::cos(scan.pitch_first_rad);
  double s = std::sin(scan.pitch_first_rad);
  const Eigen::Matrix3d R = scan.T_base_mount.linear();
  const Eigen::Vector3d t = scan.T_base_mount.translation();
  const Eigen::Vector3d& offset = scan.mirror_offset_m;
  for (std::size_t i = 0; i < n; ++i) {
    if (scan.is_hit(i)) {
      const auto r = static_cast<double>(scan.ranges_m[i]);
      const double forward = r * fan_[i].x() + offset.x();
      const Eigen::Vector3d p_mount(c * forward - s * offset.z(), r * fan_[i].y() + offset.y(),
                                    s * forward + c * offset.z());
      points_.push_back({R * p_mount + t, static_cast<std::uint32_t>(i)});
    }
    const double c_next = c * c_step - s * s_step;
    s = s * c_step + c * s_step;
    c = c_next;
  }
  return points_;
}

}  // namespace nodmap::scan
