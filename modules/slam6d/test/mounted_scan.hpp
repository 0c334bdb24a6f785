// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <random>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "common/scan/scan.hpp"
#include "modules/slam6d/sweep/mount_error.hpp"
#include "modules/slam6d/test/room.hpp"

namespace nodmap::slam6d {

/// A scan of a laser that looks higher and is rolled on its head, which neither its pitch nor its
/// mount says. Noise 1 cm.
inline scan::Scan mounted_scan(const MountError& mount, std::int64_t index, const Room& room,
                               const Motion& T_world_base, std::mt19937& random) {
  const NoddingScanner scanner;
  scan::Scan scan = scanner.scan(index, room, T_world_base, random);
  std::normal_distribution<double> noise_m(0.0, 0.01);
  const Eigen::AngleAxisd roll(mount.roll_rad, Eigen::Vector3d::UnitX());
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    const auto since =
        std::chrono::duration_cast<time::Duration>(scan.fraction(beam) * scan.duration);
    const geometry::SE3 T_world_mount = T_world_base(scan.stamp + since) * scan.T_base_mount;
    const Eigen::Vector3d direction =
        geometry::pitch_rotation(scan.pitch_rad(beam) + mount.pitch_rad) *
        (roll * scan::beam_direction(scan.angle_rad(beam), 0.0));
    scan.ranges_m[beam] = static_cast<float>(
        room.range_m(T_world_mount.translation(), T_world_mount.linear() * direction) +
        noise_m(random));
  }
  return scan;
}

/// The scans of one sweep of NoddingScanner.
inline constexpr std::int64_t kScansOfSweep = 80;

}  // namespace nodmap::slam6d
