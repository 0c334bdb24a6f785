// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/test/robot_messages.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace nodmap::foxglove::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

double pitch_rad(double time_s) {
  return 0.4 * std::sin(2.0 * std::numbers::pi * time_s / 1.2);
}

template <class Message>
void stand_at(Message& message, double x_m) {
  message.position_m[0] = x_m;
  message.orientation[0] = 1.0;
}

// Distance to the nearer wall along a beam; infinity if it is too far.
float wall_range(double angle_rad) {
  const double range_m = kHalfWidthM / std::abs(std::sin(angle_rad));
  return range_m < 20.0 ? static_cast<float>(range_m) : kInfinity;
}

}  // namespace

std::int64_t utime(double time_s) {
  return kBeginUs + std::llround(1e6 * time_s);
}

nodmap::scan_t scan_at(double time_s) {
  nodmap::scan_t message{};
  message.utime = utime(time_s);
  message.beam_duration_us = 6'660;
  message.scan_seq = std::llround(75.0 * time_s);
  message.angle_first_rad = -std::numbers::pi / 2.0;
  message.angle_step_rad = std::numbers::pi / 360.0;
  message.pitch_first_rad = pitch_rad(time_s);
  message.pitch_last_rad = message.pitch_first_rad;
  message.pitch_is_measured = 1;
  message.range_min_m = 0.1;
  message.range_max_m = 20.0;
  message.mount_position_m[0] = 0.15;
  message.mount_position_m[2] = 0.4;
  message.mount_orientation[0] = 1.0;
  message.num_ranges = 361;
  for (int beam = 0; beam < message.num_ranges; ++beam) {
    message.ranges_m.push_back(wall_range(message.angle_first_rad + beam * message.angle_step_rad));
  }
  return message;
}

nodmap::odometry_t odometry_at(double time_s) {
  nodmap::odometry_t message{};
  message.utime = utime(time_s);
  message.odometry_seq = std::llround(100.0 * time_s);
  stand_at(message, kSpeedMps * time_s);
  message.forward_mps = kSpeedMps;
  return message;
}

nodmap::pitch_state_t pitch_state_at(double time_s) {
  nodmap::pitch_state_t message{};
  message.utime = utime(time_s);
  message.state_seq = std::llround(200.0 * time_s);
  message.pitch_rad = pitch_rad(time_s);
  message.pitch_is_measured = 1;
  return message;
}

nodmap::pitch_command_t pitch_command_at(double time_s) {
  nodmap::pitch_command_t message{};
  message.utime = utime(time_s);
  message.pitch_min_rad = -0.4;
  message.pitch_max_rad = 0.1;
  message.sweep_s = 0.6;
  message.max_forward_mps = 0.8;
  return message;
}

nodmap::drive_t drive_at(double time_s) {
  nodmap::drive_t message{};
  message.utime = utime(time_s);
  message.forward_mps = kSpeedMps;
  message.valid_us = 200'000;
  return message;
}

nodmap::navigation_t navigation_at(double time_s) {
  nodmap::navigation_t message{};
  message.utime = utime(time_s);
  message.behaviour = nodmap::navigation_t::STEER;
  message.corridor_length_m = 1.5;
  message.corridor_width_m = 0.5;
  message.clear_distance_m = std::numeric_limits<double>::infinity();
  message.max_forward_mps = 0.8;
  return message;
}

nodmap::egomap_t egomap_at(double time_s) {
  nodmap::egomap_t message{};
  message.utime = utime(time_s);
  message.bin_first_rad = -std::numbers::pi;
  message.bin_step_rad = std::numbers::pi / 180.0;
  stand_at(message, kSpeedMps * time_s);
  message.num_bins = 360;
  for (int bin = 0; bin < message.num_bins; ++bin) {
    const double angle_rad = message.bin_first_rad + bin * message.bin_step_rad;
    const float range_m = wall_range(angle_rad);
    const bool seen = std::isfinite(range_m);
    message.distance_m.push_back(range_m);
    message.point_x_m.push_back(seen ? range_m * static_cast<float>(std::cos(angle_rad)) : kNan);
    message.point_y_m.push_back(seen ? range_m * static_cast<float>(std::sin(angle_rad)) : kNan);
    message.point_z_m.push_back(seen ? 0.25F : kNan);
    message.age_s.push_back(seen ? 0.5F : kNan);
  }
  return message;
}

nodmap::pose_t pose_at(double time_s) {
  nodmap::pose_t message{};
  message.utime = utime(time_s);
  stand_at(message, kSpeedMps * time_s);
  message.position_m[1] = 0.1 * time_s / 10.0;  // the error of odometry
  message.odom_position_m[1] = message.position_m[1];
  message.odom_orientation[0] = 1.0;
  message.inlier_ratio = 0.9;
  message.state = nodmap::pose_t::TRACKING;
  return message;
}

nodmap::truth_t truth_at(double time_s) {
  nodmap::truth_t message{};
  message.utime = utime(time_s);
  stand_at(message, 3.0 + kSpeedMps * time_s);
  message.forward_mps = kSpeedMps;
  message.clearance_m = 1.2;
  message.num_actors = 1;
  message.actor_position_m = {{6.0, 0.5 * std::sin(time_s)}};
  message.actor_radius_m = {0.25};
  message.actor_height_m = {1.75};
  return message;
}

nodmap::goal_t goal() {
  nodmap::goal_t message{};
  message.utime = kBeginUs;
  message.is_active = 1;
  message.position_m[0] = 8.0;
  message.tolerance_m = 0.3;
  return message;
}

nodmap::path_t path() {
  nodmap::path_t message{};
  message.utime = kBeginUs;
  message.num_points = 3;
  message.x_m = {0.0, 1.0, 2.0};
  message.y_m = {0.0, 0.0, 0.5};
  message.num_arc_points = 2;
  message.arc_x_m = {0.0, 0.8};
  message.arc_y_m = {0.0, 0.1};
  message.state = nodmap::path_t::PLANNED;
  return message;
}

nodmap::tracks_t tracks() {
  nodmap::tracks_t message{};
  message.utime = kBeginUs;
  message.num_tracks = 2;
  message.track_id = {3, 1};
  message.position_m = {{2.0, 1.0}, {-1.0, 0.0}};
  message.velocity_mps = {{-1.0, 0.0}, {0.0, 0.5}};
  message.radius_m = {0.25, 0.2};
  message.position_sigma_m = {0.05, 0.4};
  message.velocity_sigma_mps = {0.2, 0.5};
  message.state = {nodmap::tracks_t::WALKS, nodmap::tracks_t::OUT_OF_SIGHT};
  return message;
}

nodmap::exploration_t exploration() {
  nodmap::exploration_t message{};
  message.utime = kBeginUs;
  message.state = nodmap::exploration_t::EXPLORING;
  message.reason = "Driving to the next viewpoint.";
  message.seen_m2 = 40.0;
  message.waiting_m2 = 13.5;
  message.num_viewpoints = 2;
  message.viewpoint_x_m = {2.0, 5.0};
  message.viewpoint_y_m = {0.5, -1.0};
  message.gain_m2 = {10.0, 3.5};
  message.num_points = 3;
  message.x_m = {0.0, 1.0, 2.0};
  message.y_m = {0.0, 0.0, 0.5};
  message.num_frontier_points = 1;
  message.frontier_x_m = {2.5F};
  message.frontier_y_m = {0.5F};
  return message;
}

nodmap::stop_t stop() {
  nodmap::stop_t message{};
  message.utime = kBeginUs;
  message.requested_by = "nodmap-viewer";
  return message;
}

nodmap::base_sensors_t base_sensors_at(double time_s) {
  nodmap::base_sensors_t message{};
  message.utime = utime(time_s);
  message.sonar_m = kNan;
  message.roll_rad = 0.01F;
  return message;
}

nodmap::status_t status_at(double time_s) {
  nodmap::status_t message{};
  message.utime = utime(time_s);
  message.process_name = "nodmap-slam2d";
  message.health = nodmap::status_t::OK;
  message.handled_per_s = 175.0;
  message.latency_p50_us = 120.0;
  message.latency_p99_us = 900.0;
  message.total_handled = std::llround(175.0 * time_s);
  return message;
}

procman_lcm::deputy_info_t deputy_info_at(double time_s) {
  procman_lcm::deputy_info_t message{};
  message.utime = utime(time_s);
  message.deputy_id = "robot";
  message.cpu_load = 0.25F;
  message.ncmds = 1;
  message.cmds.resize(1);
  message.cmds[0].cmd.command_id = "slam2d";
  message.cmds[0].cmd.exec_str = "nodmap-slam2d";
  message.cmds[0].cmd.group = "30.slam";
  message.cmds[0].pid = 4711;
  return message;
}

}  // namespace nodmap::foxglove::test
