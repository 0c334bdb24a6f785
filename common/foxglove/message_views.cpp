// SPDX-License-Identifier: BSD-3-Clause
#include "common/foxglove/message_views.hpp"

#include <algorithm>

#include "common/foxglove/scene_views.hpp"

namespace nodmap::foxglove {
namespace {

// Foxglove's LogLevel.
constexpr int kInfo = 2;
constexpr int kWarning = 3;
constexpr int kError = 4;

}  // namespace

Json fields_of(const nodmap::base_sensors_t& message) {
  return {{"utime", message.utime},
          {"sensors_seq", message.sensors_seq},
          {"infrared_m", message.infrared_m},
          {"sonar_m", message.sonar_m},
          {"roll_rad", message.roll_rad},
          {"pitch_rad", message.pitch_rad},
          {"gyro_yaw_rad", message.gyro_yaw_rad},
          {"motor_current_left_a", message.motor_current_left_a},
          {"motor_current_right_a", message.motor_current_right_a}};
}

Json fields_of(const nodmap::drive_t& message) {
  return {{"utime", message.utime},
          {"drive_seq", message.drive_seq},
          {"forward_mps", message.forward_mps},
          {"yaw_rate_rad_s", message.yaw_rate_rad_s},
          {"valid_us", message.valid_us}};
}

Json fields_of(const nodmap::goal_t& message) {
  return {{"utime", message.utime},
          {"goal_seq", message.goal_seq},
          {"is_active", message.is_active != 0},
          {"position_m", message.position_m},
          {"tolerance_m", message.tolerance_m}};
}

Json fields_of(const nodmap::navigation_t& message) {
  return {{"utime", message.utime},
          {"drive_seq", message.drive_seq},
          {"behaviour", message.behaviour},
          {"behaviour_name", behaviour_name(message.behaviour)},
          {"reason", message.reason},
          {"steering_angle_rad", message.steering_angle_rad},
          {"corridor_length_m", message.corridor_length_m},
          {"corridor_width_m", message.corridor_width_m},
          {"free_way_m", message.free_way_m},
          {"max_forward_mps", message.max_forward_mps}};
}

Json fields_of(const nodmap::odometry_t& message) {
  return {{"utime", message.utime},
          {"odometry_seq", message.odometry_seq},
          {"position_m", message.position_m},
          {"orientation", message.orientation},
          {"forward_mps", message.forward_mps},
          {"yaw_rate_rad_s", message.yaw_rate_rad_s}};
}

Json fields_of(const nodmap::pitch_command_t& message) {
  return {{"utime", message.utime},
          {"command_seq", message.command_seq},
          {"pitch_min_rad", message.pitch_min_rad},
          {"pitch_max_rad", message.pitch_max_rad},
          {"sweep_s", message.sweep_s},
          {"max_forward_mps", message.max_forward_mps}};
}

Json fields_of(const nodmap::pitch_state_t& message) {
  return {{"utime", message.utime},
          {"state_seq", message.state_seq},
          {"pitch_rad", message.pitch_rad},
          {"pitch_rate_rad_s", message.pitch_rate_rad_s},
          {"pitch_is_measured", message.pitch_is_measured != 0},
          {"goal_pitch_rad", message.goal_pitch_rad},
          {"goal_speed_rad_s", message.goal_speed_rad_s},
          {"sweep_count", message.sweep_count},
          {"is_stalled", message.is_stalled != 0}};
}

Json fields_of(const nodmap::pose_t& message) {
  return {{"utime", message.utime},
          {"position_m", message.position_m},
          {"orientation", message.orientation},
          {"odom_position_m", message.odom_position_m},
          {"odom_orientation", message.odom_orientation},
          {"match_share", message.match_share},
          {"match_rms_m", message.match_rms_m},
          {"pose_quality", message.pose_quality}};
}

Json fields_of(const nodmap::status_t& message) {
  return {{"utime", message.utime},
          {"process_name", message.process_name},
          {"health", message.health},
          {"health_reason", message.health_reason},
          {"handled_per_s", message.handled_per_s},
          {"latency_p50_us", message.latency_p50_us},
          {"latency_p99_us", message.latency_p99_us},
          {"total_handled", message.total_handled},
          {"total_lost", message.total_lost},
          {"total_corrupt", message.total_corrupt},
          {"total_rejected", message.total_rejected}};
}

Json fields_of(const nodmap::stop_t& message) {
  return {{"utime", message.utime},
          {"stop_seq", message.stop_seq},
          {"is_stopped", message.is_stopped != 0},
          {"requested_by", message.requested_by}};
}

Json fields_of(const nodmap::truth_t& message) {
  return {{"utime", message.utime},
          {"truth_seq", message.truth_seq},
          {"position_m", message.position_m},
          {"orientation", message.orientation},
          {"forward_mps", message.forward_mps},
          {"yaw_rate_rad_s", message.yaw_rate_rad_s},
          {"pitch_rad", message.pitch_rad},
          {"clearance_m", message.clearance_m},
          {"collisions", message.collisions},
          {"bumps", message.bumps}};
}

ProcessTable::Change ProcessTable::update(const nodmap::status_t& status) {
  const auto found = processes_.find(status.process_name);
  if (found == processes_.end()) {
    if (processes_.size() >= kMaxProcesses) {
      return {};
    }
    processes_.emplace(status.process_name, status);
    return {.taken = true, .health_changed = true};
  }
  const bool changed =
      found->second.health != status.health || found->second.health_reason != status.health_reason;
  found->second = status;
  return {.taken = true, .health_changed = changed};
}

Json ProcessTable::processes() const {
  std::int64_t newest_us = 0;
  Json list = Json::array();
  for (const auto& [name, status] : processes_) {
    newest_us = std::max(newest_us, status.utime);
    list.push_back(fields_of(status));
  }
  return {{"timestamp", time_json(newest_us)}, {"processes", std::move(list)}};
}

Json health_log(const nodmap::status_t& status) {
  const bool ok = status.health == nodmap::status_t::OK;
  const bool degraded = status.health == nodmap::status_t::DEGRADED;
  const std::string state = ok ? "OK" : degraded ? "DEGRADED" : "FAILED";
  return {{"timestamp", time_json(status.utime)},
          {"level", ok         ? kInfo
                    : degraded ? kWarning
                               : kError},
          {"message", status.health_reason.empty() ? state : state + ": " + status.health_reason},
          {"name", status.process_name},
          {"file", ""},
          {"line", 0}};
}

}  // namespace nodmap::foxglove
