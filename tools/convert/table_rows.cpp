// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/table_rows.hpp"

#include <charconv>
#include <string>

namespace nodmap::convert {
namespace {

// Writes a comma and as many digits as are necessary to read the same number again.
template <class Number>
void put_number(std::ostream& out, Number value) {
  char digits[40];
  const char* end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  out << ',';
  out.write(digits, end - digits);
}

// Writes a comma and the text in quotes (RFC 4180), whatever is in it.
void put_text(std::ostream& out, const std::string& text) {
  out << ",\"";
  for (const char c : text) {
    out << (c == '"' ? "\"\"" : std::string(1, c));
  }
  out << '"';
}

template <class... Numbers>
void put(std::ostream& out, Numbers... values) {
  (put_number(out, values), ...);
}

template <class Message>
void put_pose(std::ostream& out, const Message& message) {
  for (const double value : message.position_m) {
    put(out, value);
  }
  for (const double value : message.orientation) {
    put(out, value);
  }
}

}  // namespace

const char* row_header(const nodmap::scan_t& /*message*/) {
  return ",pitch_first_rad,pitch_last_rad,angle_first_rad,angle_step_rad,ranges_m";
}

const char* row_header(const nodmap::odometry_t& /*message*/) {
  return ",x_m,y_m,z_m,qw,qx,qy,qz,forward_mps,yaw_rate_rad_s";
}

const char* row_header(const nodmap::pose_t& /*message*/) {
  return ",x_m,y_m,z_m,qw,qx,qy,qz,inlier_ratio,inlier_rms_m,state";
}

const char* row_header(const nodmap::truth_t& /*message*/) {
  return ",x_m,y_m,z_m,qw,qx,qy,qz,forward_mps,yaw_rate_rad_s,pitch_rad,clearance_m,collisions,"
         "bumps,actors_xy_m";
}

const char* row_header(const nodmap::egomap_t& /*message*/) {
  return ",x_m,y_m,z_m,qw,qx,qy,qz,bin_first_rad,bin_step_rad,points_xyz_m";
}

const char* row_header(const nodmap::pitch_state_t& /*message*/) {
  return ",pitch_rad,pitch_rate_rad_s,pitch_is_measured,goal_pitch_rad,goal_speed_rad_s,"
         "sweep_count,is_stalled";
}

const char* row_header(const nodmap::pitch_command_t& /*message*/) {
  return ",pitch_min_rad,pitch_max_rad,sweep_s,max_forward_mps";
}

const char* row_header(const nodmap::navigation_t& /*message*/) {
  return ",behaviour,steering_angle_rad,corridor_length_m,corridor_width_m,clear_distance_m,"
         "max_forward_mps,reason";
}

void put_row(std::ostream& out, const nodmap::scan_t& message) {
  put(out, message.pitch_first_rad, message.pitch_last_rad, message.angle_first_rad,
      message.angle_step_rad);
  for (const float range_m : message.ranges_m) {
    put(out, range_m);
  }
}

void put_row(std::ostream& out, const nodmap::odometry_t& message) {
  put_pose(out, message);
  put(out, message.forward_mps, message.yaw_rate_rad_s);
}

void put_row(std::ostream& out, const nodmap::pose_t& message) {
  put_pose(out, message);
  put(out, message.inlier_ratio, message.inlier_rms_m, static_cast<int>(message.state));
}

void put_row(std::ostream& out, const nodmap::truth_t& message) {
  put_pose(out, message);
  put(out, message.forward_mps, message.yaw_rate_rad_s, message.pitch_rad, message.clearance_m,
      message.collisions, message.bumps);
  for (const auto& position_m : message.actor_position_m) {
    put(out, position_m.at(0), position_m.at(1));
  }
}

void put_row(std::ostream& out, const nodmap::egomap_t& message) {
  put_pose(out, message);
  put(out, message.bin_first_rad, message.bin_step_rad);
  for (std::size_t bin = 0; bin < message.point_x_m.size(); ++bin) {
    put(out, message.point_x_m[bin], message.point_y_m[bin], message.point_z_m[bin]);
  }
}

void put_row(std::ostream& out, const nodmap::pitch_state_t& message) {
  put(out, message.pitch_rad, message.pitch_rate_rad_s, static_cast<int>(message.pitch_is_measured),
      message.goal_pitch_rad, message.goal_speed_rad_s, message.sweep_count,
      static_cast<int>(message.is_stalled));
}

void put_row(std::ostream& out, const nodmap::pitch_command_t& message) {
  put(out, message.pitch_min_rad, message.pitch_max_rad, message.sweep_s, message.max_forward_mps);
}

void put_row(std::ostream& out, const nodmap::navigation_t& message) {
  put(out, static_cast<int>(message.behaviour), message.steering_angle_rad,
      message.corridor_length_m, message.corridor_width_m, message.clear_distance_m,
      message.max_forward_mps);
  put_text(out, message.reason);
}

}  // namespace nodmap::convert
