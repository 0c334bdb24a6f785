// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/node.hpp"

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "nodmap/pitch_state_t.hpp"

namespace nodmap::laser3d {
namespace {

using serial::IoStatus;
using std::chrono::microseconds;

constexpr microseconds kWriteTimeout{50'000};

// At this rate the sensor takes bytes only with a pause of at least 55 us after each.
constexpr int kPacedBaud = 500'000;
constexpr microseconds kBytePause{60};

/// The bytes one by one: requests are short, and rare once the stream runs.
IoStatus write_paced(serial::ByteStream& stream, ByteView bytes) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const IoStatus status = stream.write(bytes.subspan(i, 1), kWriteTimeout);
    if (status != IoStatus::kOk) {
      return status;
    }
    std::this_thread::sleep_for(kBytePause);
  }
  return IoStatus::kOk;
}

}  // namespace

Laser3dNode::Laser3dNode(node::Context& context, const Laser3dParams& params, Openers open,
                         std::function<time::Moment()> clock)
    : context_(context),
      params_(params),
      driver_(params),
      laser_{serial::ReconnectingPort(std::move(open.laser)), false, params.laser_baud},
      servo_{serial::ReconnectingPort(std::move(open.servo)), false, params.servo_baud},
      clock_(std::move(clock)) {
  context_.bus.subscribe<nodmap::pitch_command_t>(
      "PITCH_COMMAND", [this](const nodmap::pitch_command_t& message) { on_command(message); });
}

void Laser3dNode::spin_once() {
  const time::Moment now = clock_();
  attend(laser_, now);
  attend(servo_, now);
  carry_out(driver_.poll(now.steady_us), now);
  const std::int64_t lost =
      driver_.counts().telegrams_missed + driver_.counts().scans_without_pitch;
  context_.counts.lose(lost - std::exchange(told_lost_, lost));
  tell_change(now);
}

std::array<int, 2> Laser3dNode::poll_handles() {
  const auto handle = [](Line& line) {
    serial::ByteStream* stream = line.port.is_open() ? line.port.stream(0) : nullptr;
    return stream != nullptr ? stream->poll_handle() : -1;
  };
  return {handle(laser_), handle(servo_)};
}

void Laser3dNode::shut_down() {
  const time::Moment now = clock_();
  carry_out(driver_.shut_down(now.steady_us), now);
}

void Laser3dNode::attend(Line& line, const time::Moment& now) {
  const bool is_laser = &line == &laser_;
  serial::ByteStream* stream = line.port.stream(now.steady_us);
  if (stream == nullptr) {
    return;
  }
  if (!std::exchange(line.connected, true)) {
    carry_out(is_laser ? driver_.laser_opened(now.steady_us) : driver_.servo_opened(now.steady_us),
              now);
    return;
  }
  std::array<std::uint8_t, 4096> buffer{};
  const serial::ReadResult result = stream->read(buffer, microseconds(0));
  if (result.status == IoStatus::kDisconnected) {
    lose(line, now, "the line is disconnected");
    return;
  }
  const auto bytes = ByteView(buffer).first(result.count);
  carry_out(is_laser ? driver_.receive_laser(bytes, now.steady_us)
                     : driver_.receive_servo(bytes, now.steady_us),
            now);
}

void Laser3dNode::lose(Line& line, const time::Moment& now, const std::string& reason) {
  line.port.give_up(now.steady_us, reason);
  line.connected = false;
  if (&line == &laser_) {
    driver_.laser_lost();
  } else {
    driver_.servo_lost();
  }
}

void Laser3dNode::carry_out(Laser3dOutput output, const time::Moment& now) {
  for (const PitchState& state : output.pitch) {
    publish(state, now);
  }
  for (scan::Scan& scan : output.scans) {
    publish(std::move(scan), now);
  }
  for (const LineAction& action : output.laser) {
    perform(laser_, action, now);
  }
  for (const LineAction& action : output.servo) {
    perform(servo_, action, now);
  }
}

void Laser3dNode::perform(Line& line, const LineAction& action, const time::Moment& now) {
  serial::ByteStream* stream = line.port.is_open() ? line.port.stream(now.steady_us) : nullptr;
  if (stream == nullptr) {
    return;
  }
  if (action.baud) {
    if (!stream->set_baud(*action.baud)) {
      log::get().warn("the line does not go at {} bit/s", *action.baud);
    }
    stream->discard_input();
    line.baud = *action.baud;
  }
  const bool paced = &line == &laser_ && line.baud == kPacedBaud;
  const IoStatus status = action.send.empty() ? IoStatus::kOk
                          : paced             ? write_paced(*stream, action.send)
                                              : stream->write(action.send, kWriteTimeout);
  if (status != IoStatus::kOk) {
    lose(line, now,
         status == IoStatus::kTimeout ? "the line takes no bytes" : "the line is disconnected");
  }
}

void Laser3dNode::on_command(const nodmap::pitch_command_t& message) {
  const time::Moment now = clock_();
  // Any number may come: in integers the difference could overflow.
  const double age_us = static_cast<double>(now.utime_us) - static_cast<double>(message.utime);
  if (std::abs(1e-6 * age_us) > params_.command_timeout_s) {
    context_.counts.reject("stale");
    return;
  }
  const AreaOfInterest area{message.pitch_min_rad, message.pitch_max_rad, message.sweep_s};
  if (driver_.command(area, now.steady_us)) {
    context_.counts.use();
  } else {
    context_.counts.reject("no_area");
  }
}

void Laser3dNode::publish(const PitchState& state, const time::Moment& now) {
  nodmap::pitch_state_t message{};
  message.utime = state.sample.time_us + (now.utime_us - now.steady_us);
  message.state_seq = state_seq_++;
  message.pitch_rad = state.sample.pitch_rad;
  message.pitch_rate_rad_s = state.sample.rate_rad_s;
  message.pitch_is_measured = state.measured ? 1 : 0;
  message.goal_pitch_rad = state.aim.goal_rad;
  message.goal_speed_rad_s = state.aim.speed_rad_s;
  message.sweep_count = state.sweep;
  message.is_stalled = state.stalled ? 1 : 0;
  context_.bus.publish("PITCH_STATE", message);
}

void Laser3dNode::publish(scan::Scan scan, const time::Moment& now) {
  scan.utime_us += now.utime_us - now.steady_us;
  context_.bus.publish("SCAN", node::write_scan(scan));
}

void Laser3dNode::tell_change(const time::Moment& now) {
  const Judgement judgement = driver_.judge(now.steady_us);
  if (judgement.reason == told_) {
    return;
  }
  told_ = judgement.reason;
  if (told_.empty()) {
    log::get().info("scanning");
  } else {
    log::get().warn("{}", told_);
  }
}

nlohmann::json Laser3dNode::metrics() const {
  const Laser3d::Counts& scanner = driver_.counts();
  const SickSession::Counts& laser = driver_.laser_counts();
  const SickParser::Counts& line = driver_.laser_line();
  const ServoCounts servo = driver_.servo_line();
  return {{"scans", scanner.scans},
          {"scans_without_pitch", scanner.scans_without_pitch},
          {"telegrams_missed", scanner.telegrams_missed},
          {"dazzled_beams", scanner.dazzled_beams},
          {"scans_blind", scanner.scans_blind},
          {"telegrams", line.telegrams},
          {"checksum_errors", line.checksum_errors},
          {"implausible_frames", line.implausible},
          {"expired_frames", line.expired},
          {"skipped_bytes", line.skipped_bytes},
          {"laser_connections", laser.connections},
          {"laser_freezes", laser.freezes},
          {"laser_power_ons", laser.power_ons},
          {"config_writes", laser.config_writes},
          {"laser_reconnects", laser_.port.reconnects()},
          {"servo_unanswered", servo.unanswered},
          {"servo_damaged_requests", servo.damaged},
          {"servo_checksum_errors", servo.checksum_errors},
          {"servo_implausible", servo.implausible},
          {"servo_reconnects", servo_.port.reconnects()}};
}

node::Health Laser3dNode::health() const {
  if (!laser_.port.is_open()) {
    return {node::HealthState::kFailed, "laser: " + laser_.port.error()};
  }
  if (!servo_.port.is_open()) {
    return {node::HealthState::kFailed, "servo: " + servo_.port.error()};
  }
  const Judgement judgement = driver_.judge(clock_().steady_us);
  switch (judgement.condition) {
    case Condition::kOk:
      return {node::HealthState::kOk, "", false};
    case Condition::kDegraded:
      return {node::HealthState::kDegraded, judgement.reason};
    case Condition::kFailed:
      break;
  }
  return {node::HealthState::kFailed, judgement.reason};
}

}  // namespace nodmap::laser3d
