// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/messages.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/formats/text_lines.hpp"

namespace nodmap::node {
namespace {

// Planar lasers have at most some thousand beams.
constexpr std::size_t kMaxRanges = 16'384;
constexpr std::size_t kMaxNameLength = 100;

}  // namespace

std::optional<geometry::SE3> read_pose(const double (&position_m)[3],
                                       const double (&orientation)[4]) {
  const Eigen::Vector3d position(position_m[0], position_m[1], position_m[2]);
  Eigen::Quaterniond rotation(orientation[0], orientation[1], orientation[2], orientation[3]);
  const double length = rotation.norm();
  // An error of more than 1 % is not rounding: the message was never filled in.
  if (!position.allFinite() || position.cwiseAbs().maxCoeff() > kFarthestM ||
      !(std::abs(length - 1.0) < 0.01)) {
    return std::nullopt;
  }
  rotation.normalize();
  return geometry::make_se3(position, rotation);
}

void write_pose(const geometry::SE3& pose, double (&position_m)[3], double (&orientation)[4]) {
  Eigen::Quaterniond q(pose.linear());
  if (q.w() < 0.0) {
    q.coeffs() = -q.coeffs();
  }
  for (int i = 0; i < 3; ++i) {
    position_m[i] = pose.translation()[i];
  }
  orientation[0] = q.w();
  orientation[1] = q.x();
  orientation[2] = q.y();
  orientation[3] = q.z();
}

bool read_scan(const nodmap::scan_t& message, scan::Scan& scan) {
  const auto T_base_mount = read_pose(message.mount_position_m, message.mount_orientation);
  if (!T_base_mount || message.num_ranges < 0 ||
      static_cast<std::size_t>(message.num_ranges) != message.ranges_m.size() ||
      message.ranges_m.size() > kMaxRanges) {
    return false;
  }
  scan.stamp = time::from_utime(message.utime);
  scan.duration = time::from_us(message.beam_duration_us);
  scan.seq = message.scan_seq;
  scan.angle_first_rad = message.angle_first_rad;
  scan.angle_step_rad = message.angle_step_rad;
  scan.pitch_first_rad = message.pitch_first_rad;
  scan.pitch_last_rad = message.pitch_last_rad;
  scan.pitch_measured = message.pitch_is_measured != 0;
  scan.range_min_m = message.range_min_m;
  scan.range_max_m = message.range_max_m;
  scan.T_base_mount = *T_base_mount;
  scan.mirror_offset_m = Eigen::Vector3d(message.mirror_offset_m);
  scan.ranges_m.assign(message.ranges_m.begin(), message.ranges_m.end());
  return is_plausible(scan);
}

nodmap::scan_t write_scan(const scan::Scan& scan) {
  nodmap::scan_t message{};
  message.utime = time::to_utime(scan.stamp);
  message.beam_duration_us = time::to_us(scan.duration);
  message.scan_seq = scan.seq;
  message.angle_first_rad = scan.angle_first_rad;
  message.angle_step_rad = scan.angle_step_rad;
  message.pitch_first_rad = scan.pitch_first_rad;
  message.pitch_last_rad = scan.pitch_last_rad;
  message.pitch_is_measured = scan.pitch_measured ? 1 : 0;
  message.range_min_m = scan.range_min_m;
  message.range_max_m = scan.range_max_m;
  write_pose(scan.T_base_mount, message.mount_position_m, message.mount_orientation);
  std::copy_n(scan.mirror_offset_m.data(), 3, message.mirror_offset_m);
  message.num_ranges = static_cast<std::int32_t>(scan.ranges_m.size());
  message.ranges_m = scan.ranges_m;
  message.num_intensities = 0;
  return message;
}

std::optional<geometry::SE3> read_odometry(const nodmap::odometry_t& message) {
  return read_pose(message.position_m, message.orientation);
}

bool is_plausible(const nodmap::pitch_state_t& message) {
  return time::is_plausible(stamp_of(message)) && message.sweep_count >= 0 &&
         std::abs(message.pitch_rad) <= geometry::kPi && std::isfinite(message.pitch_rate_rad_s);
}

std::string read_name(std::string_view name) {
  return formats::printable(name.substr(0, kMaxNameLength));
}

nodmap::odometry_t write_odometry(time::Timestamp stamp, const geometry::SE3& T_odom_base) {
  nodmap::odometry_t message{};
  message.utime = time::to_utime(stamp);
  write_pose(T_odom_base, message.position_m, message.orientation);
  message.pose_covariance[0][0] = std::numeric_limits<double>::quiet_NaN();
  return message;
}

nodmap::pose_t write_corrected_pose(time::Timestamp stamp, const geometry::SE3& T_map_base,
                                    const geometry::SE3& T_map_odom) {
  nodmap::pose_t message{};
  message.utime = time::to_utime(stamp);
  write_pose(T_map_base, message.position_m, message.orientation);
  write_pose(T_map_odom, message.odom_position_m, message.odom_orientation);
  return message;
}

}  // namespace nodmap::node
