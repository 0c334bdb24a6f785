// SPDX-License-Identifier: BSD-3-Clause
// Conversion of messages to values and back, one pair of functions per type. Reading checks what
// can still be wrong in a decoded message: numbers that are not finite, quaternions of wrong
// length, counts that do not match.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "common/scan/scan.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "nodmap/pose_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::node {

/// The greatest coordinate of a plausible place: farther than any robot drives, and small enough
/// for cell indices of 32 bits.
inline constexpr double kFarthestM = 1e6;

/// Reads a pose from position (m) and quaternion (w, x, y, z). Empty if a number is not finite, a
/// coordinate is beyond kFarthestM, or the quaternion's length differs from 1 by more than 1 %.
[[nodiscard]] std::optional<geometry::SE3> read_pose(const double (&position_m)[3],
                                                     const double (&orientation)[4]);

/// Writes the position (m) and the quaternion (w, x, y, z, with w >= 0) of a pose.
void write_pose(const geometry::SE3& pose, double (&position_m)[3], double (&orientation)[4]);

/// A square matrix as a message holds it: row by row.
template <std::size_t N>
using MatrixRows = Eigen::Matrix<double, static_cast<int>(N), static_cast<int>(N), Eigen::RowMajor>;

template <std::size_t N>
[[nodiscard]] MatrixRows<N> read_matrix(const double (&in)[N][N]) {
  return Eigen::Map<const MatrixRows<N>>(&in[0][0]);
}
template <std::size_t N>
void write_matrix(const MatrixRows<N>& matrix, double (&out)[N][N]) {
  Eigen::Map<MatrixRows<N>> rows(&out[0][0]);
  rows = matrix;
}

/// Reads a message into `scan`, reusing its memory. Returns false and leaves `scan` unspecified if
/// the message is not a plausible scan.
[[nodiscard]] bool read_scan(const nodmap::scan_t& message, scan::Scan& scan);
[[nodiscard]] nodmap::scan_t write_scan(const scan::Scan& scan);

/// Reads the odometry pose T_odom_base at the message's utime.
[[nodiscard]] std::optional<geometry::SE3> read_odometry(const nodmap::odometry_t& message);

/// Whether a pitch state is one that a head can have: a sweep's number from 0 on, a pitch within
/// half a revolution, a finite rate.
[[nodiscard]] bool is_plausible(const nodmap::pitch_state_t& message);

/// The stamp of a message: when its content was measured, or when it was sent.
[[nodiscard]] time::Timestamp stamp_of(const auto& message) {
  return time::from_utime(message.utime);
}

/// The name of a requester as it may be logged and repeated: any process can send a name of any
/// length and with any bytes. At most 100 characters; those that are not printable ASCII become
/// '?'.
[[nodiscard]] std::string read_name(std::string_view name);

/// Makes an odometry message with unknown covariance; speed and yaw rate are zero.
[[nodiscard]] nodmap::odometry_t write_odometry(time::Timestamp stamp,
                                                const geometry::SE3& T_odom_base);

/// A pose message with both frames' poses; the match and quality fields are the caller's.
[[nodiscard]] nodmap::pose_t write_corrected_pose(time::Timestamp stamp,
                                                  const geometry::SE3& T_map_base,
                                                  const geometry::SE3& T_map_odom);

}  // namespace nodmap::node
