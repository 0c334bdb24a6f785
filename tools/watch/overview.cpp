// SPDX-License-Identifier: BSD-3-Clause
#include "tools/watch/overview.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/angle.hpp"
#include "nodmap/json_messages.hpp"

namespace nodmap::watch {
namespace {

constexpr double kJumpM = 1.0;  // a larger step means that odometry was restarted
constexpr std::size_t kLineLength = 132;

std::string behaviour_name(const Overview& overview) {
  return overview.behaviour()
             ? JsonMessage<nodmap::navigation_t>::constant_name(*overview.behaviour())
             : "-";
}

}  // namespace

void Rate::add(time::SteadyTime now) {
  ++total_;
  received_.push_back(now);
  while (received_.front() <= now - 1s) {
    received_.pop_front();
  }
}

double Rate::per_second(time::SteadyTime now) const {
  return static_cast<double>(
      std::ranges::count_if(received_, [now](time::SteadyTime stamp) { return stamp > now - 1s; }));
}

void Overview::add(const nodmap::scan_t& /*message*/, time::SteadyTime now) {
  scans_.add(now);
}

void Overview::add(const nodmap::odometry_t& message, time::SteadyTime now) {
  odometry_.add(now);
  forward_mps_ = message.forward_mps;
  yaw_rate_rad_s_ = message.yaw_rate_rad_s;
  max_forward_mps_ = std::max(max_forward_mps_, std::abs(message.forward_mps));
  const double step_m =
      std::hypot(message.position_m[0] - last_x_m_, message.position_m[1] - last_y_m_);
  if (has_position_ && step_m < kJumpM) {
    distance_m_ += step_m;
  }
  has_position_ = true;
  last_x_m_ = message.position_m[0];
  last_y_m_ = message.position_m[1];
}

void Overview::add(const nodmap::exploration_t& message, time::SteadyTime /*now*/) {
  is_home_ = message.state == nodmap::exploration_t::HOME;
  const bool is_idle = message.state == nodmap::exploration_t::IDLE;
  given_up_.reset();
  if (is_idle && was_exploring_) {
    given_up_ = message.reason;
  }
  was_exploring_ |= !is_idle;
  seen_m2_ = message.seen_m2;
}

void Overview::add(const nodmap::pitch_state_t& message, time::SteadyTime /*now*/) {
  pitch_rad_ = message.pitch_rad;
}

void Overview::add(const nodmap::egomap_t& obstacle_map, time::SteadyTime /*now*/) {
  nearest_m_ = std::numeric_limits<double>::infinity();
  for (const float distance_m : obstacle_map.distance_m) {
    nearest_m_ = std::min(nearest_m_, static_cast<double>(distance_m));
  }
}

void Overview::add(const nodmap::navigation_t& message, time::SteadyTime /*now*/) {
  behaviour_ = message.behaviour;
  reason_ = message.reason;
}

void Overview::add(const nodmap::cloud_chunk_t& message, time::SteadyTime /*now*/) {
  // The numbers begin again with the map.
  keyframes_ = message.keyframe_id == 0 ? 1 : std::max(keyframes_, message.keyframe_id + 1);
}

void Overview::add(const nodmap::status_t& message, time::SteadyTime now) {
  processes_[message.process_name] = {
      message.health,        message.health_reason,  message.total_handled,  message.total_lost,
      message.total_corrupt, message.total_rejected, message.latency_p99_us, now};
}

void Overview::add(const nodmap::truth_t& message, time::SteadyTime /*now*/) {
  collisions_ = message.collisions;
  bumps_ = message.bumps;
}

std::int64_t Overview::lost() const {
  std::int64_t sum = 0;
  for (const auto& [name, process] : processes_) {
    sum += process.lost + process.corrupt;
  }
  return sum;
}

std::string status_line(const Overview& overview, time::SteadyTime now) {
  std::string line = fmt::format(
      "{:<7} {:5.2f} m/s {:+4.0f} deg/s  pitch {:+5.1f} deg  nearest {:5.2f} m  keyframes {:<3} "
      "scans {:3.0f}/s  odometry {:3.0f}/s  lost {}",
      behaviour_name(overview), overview.forward_mps(),
      geometry::rad_to_deg(overview.yaw_rate_rad_s()), geometry::rad_to_deg(overview.pitch_rad()),
      overview.nearest_m(), overview.keyframes(), overview.scans().per_second(now),
      overview.odometry().per_second(now), overview.lost());
  if (overview.collisions() >= 0) {
    line += fmt::format("  collisions {}", overview.collisions());
  }
  return line.substr(0, kLineLength);
}

}  // namespace nodmap::watch
