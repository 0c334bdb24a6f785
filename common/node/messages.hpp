// SPDX-License-Identifier: BSD-3-Clause
// Messages to values and back, one function pair per type. Reading checks everything a decoded
// message can still get wrong: numbers that are not finite, quaternions of no length, counts that
// do not match.
#pragma once

#include <optional>

#include "common/geometry/se3.hpp"
#include "common/scan/scan.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/pose_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::node {

/// A pose from position (m) and quaternion (w, x, y, z); empty when not finite or the quaternion is
/// not of length 1 (to 1 %).
[[nodiscard]] std::optional<geometry::SE3> read_pose(const double (&position_m)[3],
                                                     const double (&orientation)[4]);

/// Position (m) and quaternion (w, x, y, z, with w >= 0) of a pose.
void write_pose(const geometry::SE3& pose, double (&position_m)[3], double (&orientation)[4]);

/// Reads into `scan`, reusing its memory. False, and `scan` unspecified, when the message is no
/// plausible scan.
[[nodiscard]] bool read_scan(const nodmap::scan_t& message, scan::Scan& scan);
[[nodiscard]] nodmap::scan_t write_scan(const scan::Scan& scan);

/// Where the robot was by its odometry: T_odom_base at the message's utime.
[[nodiscard]] std::optional<geometry::SE3> read_odometry(const nodmap::odometry_t& message);

/// An odometry message with unknown covariance; speed and turn rate are left at zero.
[[nodiscard]] nodmap::odometry_t write_odometry(std::int64_t utime_us,
                                                const geometry::SE3& T_odom_base);

/// A pose message with both frames' poses; the match and quality fields are the caller's.
[[nodiscard]] nodmap::pose_t write_corrected_pose(std::int64_t utime_us,
                                                  const geometry::SE3& T_map_base,
                                                  const geometry::SE3& T_map_odom);

}  // namespace nodmap::node
