// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/node.hpp"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "nodmap/pitch_state_t.hpp"

namespace nodmap::laser3d {
namespace {

// At this rate the sensor needs a pause of at least 55 us after each byte. Requests are short, and
// rare once the stream runs.
constexpr int kPacedBaud = 500'000;
constexpr time::Duration kBytePause = 60us;

}  // namespace

Laser3dNode::Laser3dNode(node::Context& context, const Laser3dParams& params, Openers open,
                         std::function<time::Moment()> clock)
    : context_(context),
      params_(params),
      driver_(params),
      laser_("laser", std::move(open.laser),
             {.opened =
                  [this](const time::Moment& now) {
                    carry_out(driver_.laser_opened(now.steady), now);
                  },
              .received =
                  [this](ByteView bytes, const time::Moment& now) {
                    carry_out(driver_.receive_laser(bytes, now.steady), now);
                  },
              .lost = [this] { driver_.laser_lost(); }}),
      servo_("servo", std::move(open.servo),
             {.opened =
                  [this](const time::Moment& now) {
                    carry_out(driver_.servo_opened(now.steady), now);
                  },
              .received =
                  [this](ByteView bytes, const time::Moment& now) {
                    carry_out(driver_.receive_servo(bytes, now.steady), now);
                  },
              .lost = [this] { driver_.servo_lost(); }}),
      laser_baud_(params.laser.baud),
      clock_(std::move(clock)) {
  context_.bus.subscribe<nodmap::pitch_command_t>(
      "PITCH_COMMAND", [this](const nodmap::pitch_command_t& message) { on_command(message); });
}

void Laser3dNode::spin_once() {
  laser_.poll(clock_());
  // A request to the laser may have taken milliseconds, and the servo's bytes are stamped.
  const time::Moment now = clock_();
  servo_.poll(now);
  carry_out(driver_.poll(now.steady), now);
  const std::int64_t lost =
      driver_.counts().telegrams_missed + driver_.counts().scans_without_pitch;
  context_.counts.lose(lost - std::exchange(reported_lost_, lost));
  log_change(now);
}

std::array<int, 2> Laser3dNode::poll_handles() {
  return {laser_.poll_handle(), servo_.poll_handle()};
}

void Laser3dNode::shut_down() {
  const time::Moment now = clock_();
  carry_out(driver_.shut_down(now.steady), now);
}

void Laser3dNode::carry_out(Laser3dOutput output, const time::Moment& now) {
  for (const PitchState& state : output.pitch) {
    publish(state, now);
  }
  for (SteadyScan& scan : output.scans) {
    publish(std::move(scan), now);
  }
  for (const LineAction& action : output.laser) {
    perform(laser_, action, now);
  }
  for (const LineAction& action : output.servo) {
    perform(servo_, action, now);
  }
}

void Laser3dNode::perform(serial::SerialLink& link, const LineAction& action,
                          const time::Moment& now) {
  const bool is_laser = &link == &laser_;
  if (action.baud) {
    link.set_baud(*action.baud);
    laser_baud_ = is_laser ? *action.baud : laser_baud_;
  }
  if (!action.send.empty()) {
    serial::SerialLink::WriteOptions options;
    options.byte_pause = is_laser && laser_baud_ == kPacedBaud ? kBytePause : options.byte_pause;
    link.write(action.send, now, options);
  }
}

void Laser3dNode::on_command(const nodmap::pitch_command_t& message) {
  const time::Moment now = clock_();
  const bus::Origin& origin = context_.bus.origin();
  const time::Duration age = now.wall - time::from_utime(message.utime);
  if (std::abs(time::seconds(age)) > params_.nod.command_timeout_s) {
    sender_.refuse(origin.sender, origin.arrived);
    context_.counts.reject("stale");
    return;
  }
  if (!sender_.follow(origin.sender, origin.arrived) || sender_.is_contested(now.steady)) {
    context_.counts.reject("other_sender");
    return;
  }
  const AreaOfInterest area{message.pitch_min_rad, message.pitch_max_rad, message.sweep_s};
  if (driver_.command(area, now.steady - std::max(age, time::Duration{}))) {
    context_.counts.use();
  } else {
    context_.counts.reject("no_area");
  }
}

void Laser3dNode::publish(const PitchState& state, const time::Moment& now) {
  nodmap::pitch_state_t message{};
  message.utime = time::to_utime(now.wall_at(state.sample.stamp));
  message.state_seq = state_seq_++;
  message.pitch_rad = state.sample.pitch_rad;
  message.pitch_rate_rad_s = state.sample.rate_rad_s;
  message.pitch_is_measured = state.is_measured ? 1 : 0;
  message.goal_pitch_rad = state.aim.goal_rad;
  message.goal_speed_rad_s = state.aim.speed_rad_s;
  message.sweep_count = state.sweep;
  message.is_stalled = state.is_stalled ? 1 : 0;
  context_.bus.publish("PITCH_STATE", message);
}

void Laser3dNode::publish(SteadyScan scan, const time::Moment& now) {
  scan.scan.stamp = now.wall_at(scan.first_beam);
  context_.bus.publish("SCAN", node::write_scan(scan.scan));
}

void Laser3dNode::log_change(const time::Moment& now) {
  const node::Health health = driver_.health(now.steady);
  if (health.reason == logged_) {
    return;
  }
  logged_ = health.reason;
  if (logged_.empty()) {
    log::get().info("scanning");
  } else {
    log::get().warn("{}", logged_);
  }
}

nlohmann::json Laser3dNode::metrics() const {
  const Laser3d::Counts& scanner = driver_.counts();
  const SickSession::Counts& laser = driver_.laser_counts();
  const SickParser& parser = driver_.laser_line();
  const serial::FrameScanner::Errors& errors = parser.errors();
  const ServoCounts servo = driver_.servo_counts();
  return {{"scans", scanner.scans},
          {"scans_without_pitch", scanner.scans_without_pitch},
          {"telegrams_missed", scanner.telegrams_missed},
          {"dazzled_beams", scanner.dazzled_beams},
          {"scans_blind", scanner.scans_blind},
          {"telegrams", parser.telegrams()},
          {"checksum_errors", errors.checksum},
          {"implausible_frames", errors.implausible},
          {"expired_frames", errors.expired},
          {"skipped_bytes", errors.skipped_bytes},
          {"laser_connections", laser.connections},
          {"laser_unexpected_scans", laser.unexpected_scans},
          {"laser_stream_stops", laser.stream_stops},
          {"laser_freezes", laser.freezes},
          {"laser_power_ons", laser.power_ons},
          {"config_writes", laser.config_writes},
          {"laser_reconnects", laser_.reconnects()},
          {"servo_connections", servo.connections},
          {"servo_unanswered", servo.unanswered},
          {"servo_damaged_requests", servo.damaged},
          {"servo_checksum_errors", servo.checksum_errors},
          {"servo_implausible", servo.implausible},
          {"servo_shutdowns", servo.shutdowns},
          {"servo_reconnects", servo_.reconnects()}};
}

node::Health Laser3dNode::health() const {
  if (!laser_.is_open()) {
    return {node::HealthState::kFailed, "laser: " + laser_.error()};
  }
  if (!servo_.is_open()) {
    return {node::HealthState::kFailed, "servo: " + servo_.error()};
  }
  const time::SteadyTime now = clock_().steady;
  if (sender_.is_contested(now)) {
    return {node::HealthState::kFailed,
            "two processes send PITCH_COMMAND: neither is obeyed until one has ended"};
  }
  return driver_.health(now);
}

}  // namespace nodmap::laser3d
