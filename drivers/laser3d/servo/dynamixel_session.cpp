// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/servo/dynamixel_session.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace nodmap::laser3d {
namespace {

// Twice the latency of a USB adapter that was left as it came (16 ms), and some for the bytes.
constexpr std::int64_t kAnswerUs = 40'000;
constexpr int kMissesAllowed = 3;
constexpr std::int64_t kRebootUs = 1'000'000;
constexpr int kDamagedRequest = 3;          // error code: the servo's own check of the checksum
constexpr std::uint8_t kWatchdog20Ms = 10;  // 200 ms

// The servo reads its registers, waits (its return delay as delivered) and sends the first byte.
constexpr std::int64_t kReturnDelayUs = 500;
// It counts whole milliseconds: on average half a one more has passed.
constexpr std::int64_t kHalfTickUs = 500;

std::string alert_text(std::uint8_t bits) {
  std::string text = "the servo switched itself off:";
  const auto add = [&](unsigned bit, const char* word) {
    if ((bits >> bit & 1U) != 0) {
      text += word;
    }
  };
  add(0, " supply voltage");
  add(2, " overheated");
  add(3, " encoder");
  add(4, " electrical shock");
  add(5, " overload");
  return text;
}

}  // namespace

DynamixelSession::DynamixelSession(const ServoParams& params, double acceleration_rad_s2)
    : params_(params),
      id_(static_cast<std::uint8_t>(params.id)),
      acceleration_rad_s2_(acceleration_rad_s2),
      parser_(params.baud),
      sync_({.tick_us = 1000.0, .wrap_ticks = dynamixel_x::kTickWrap, .max_drift = 0.001}) {}

ServoOutput DynamixelSession::open(std::int64_t now_us) {
  last_error_ = "being started";
  parser_.reset(params_.baud);
  back_off_.succeeded();
  return enter(Step::kPing, now_us);
}

void DynamixelSession::close() {
  step_ = Step::kClosed;
  last_error_ = "not connected";
}

ServoCounts DynamixelSession::line_counts() const {
  return {.unanswered = counts_.unanswered,
          .damaged = counts_.damaged,
          .checksum_errors = parser_.errors().checksum,
          .implausible = counts_.implausible};
}

void DynamixelSession::aim(double goal_rad, double speed_rad_s) {
  if (goal_rad != goal_rad_ || speed_rad_s != speed_rad_s_) {
    goal_rad_ = goal_rad;
    speed_rad_s_ = speed_rad_s;
    move_pending_ = true;
  }
}

ServoOutput DynamixelSession::poll(std::int64_t now_us) {
  if (step_ == Step::kClosed) {
    return {};
  }
  if (waiting_) {
    if (now_us < deadline_us_) {
      return {};
    }
    ++counts_.unanswered;
    return missed(now_us);
  }
  if (step_ == Step::kRun) {
    return run(now_us);
  }
  // kReboot and kWait are left when their time is over; every other step waits for an answer.
  return now_us < deadline_us_ ? ServoOutput{} : enter(Step::kPing, now_us);
}

ServoOutput DynamixelSession::receive(ByteView bytes, std::int64_t now_us) {
  parser_.feed(bytes, now_us);
  ServoOutput output;
  while (const auto answer = parser_.next()) {
    if (answer->id == id_ && waiting_) {
      output = take(*answer, now_us);
    }
  }
  return output;
}

ServoOutput DynamixelSession::run(std::int64_t now_us) {
  if (move_pending_) {
    move_pending_ = false;
    const double steps =
        (params_.dynamixel.inverted ? -goal_rad_ : goal_rad_) / dynamixel_x::kRadPerStep;
    const auto position =
        params_.dynamixel.level_position + static_cast<std::int32_t>(std::lround(steps));
    return ask(dynamixel_x::move_to(id_, position, speed_rad_s_), now_us);
  }
  if (now_us < next_reading_us_) {
    return {};
  }
  // Keeps its pace, but does not catch up what a busy line lost.
  next_reading_us_ = std::max(next_reading_us_ + params_.period_us(), now_us);
  return ask(dynamixel_x::read_state(id_), now_us);
}

Bytes DynamixelSession::request() const {
  using namespace dynamixel_x;  // NOLINT(google-build-using-namespace): the register names
  switch (step_) {
    case Step::kPing:
      return dynamixel::ping(id_);
    case Step::kClearWatchdog:
      return write_byte(id_, kBusWatchdog, 0);
    case Step::kTorqueOff:
      return write_byte(id_, kTorqueEnable, 0);
    case Step::kReadMode:
      return dynamixel::read(id_, kOperatingMode, 1);
    case Step::kWriteMode:
      return write_byte(id_, kOperatingMode, kPositionControl);
    case Step::kAcceleration:
      return set_acceleration(id_, acceleration_rad_s2_);
    case Step::kTorqueOn:
      return write_byte(id_, kTorqueEnable, 1);
    case Step::kWatchdog:
      return write_byte(id_, kBusWatchdog, kWatchdog20Ms);
    case Step::kReadAlert:
      return dynamixel::read(id_, kHardwareError, 1);
    case Step::kReboot:
      return dynamixel::reboot(id_);
    default:
      return {};
  }
}

ServoOutput DynamixelSession::enter(Step step, std::int64_t now_us) {
  step_ = step;
  misses_ = 0;
  return ask(request(), now_us);
}

ServoOutput DynamixelSession::ask(Bytes bytes, std::int64_t now_us) {
  waiting_ = !bytes.empty();
  deadline_us_ = now_us + kAnswerUs;
  return {.send = std::move(bytes), .sample = std::nullopt};
}

ServoOutput DynamixelSession::missed(std::int64_t now_us) {
  if (step_ == Step::kReboot) {
    waiting_ = false;  // its answer may be lost in the restart
    deadline_us_ = now_us + kRebootUs;
    return {};
  }
  if (++misses_ > kMissesAllowed) {
    return fail("the servo does not answer", now_us);
  }
  if (step_ == Step::kRun) {
    waiting_ = false;
    move_pending_ = true;  // nobody knows whether the lost one was a move
    return run(now_us);
  }
  return ask(request(), now_us);
}

ServoOutput DynamixelSession::take(const DynamixelStatus& answer, std::int64_t now_us) {
  waiting_ = false;
  if (!answer.hardware_alert() && answer.error_code() == kDamagedRequest) {
    ++counts_.damaged;
    return missed(now_us);  // it has done nothing: no different from not having heard
  }
  misses_ = 0;
  if (answer.hardware_alert() && step_ != Step::kReadAlert && step_ != Step::kReboot) {
    ++counts_.alerts;
    return enter(Step::kReadAlert, now_us);
  }
  if (answer.error_code() != 0) {
    ++counts_.refused;
    return fail("the servo refuses a command (error " + std::to_string(answer.error_code()) + ")",
                now_us);
  }
  if (step_ != Step::kRun) {
    return advance(answer, now_us);
  }
  const std::optional<dynamixel_x::State> state = dynamixel_x::state_in(answer);
  if (!state) {
    return run(now_us);  // the answer to a move
  }
  if (has_restarted(*state, now_us)) {
    return fail("the servo has been restarted", now_us);
  }
  ServoOutput output = run(now_us);  // the line is free for a move
  output.sample = sample_of(*state, answer.first_byte_us);
  return output;
}

ServoOutput DynamixelSession::advance(const DynamixelStatus& answer, std::int64_t now_us) {
  const auto value = [&answer] {
    return answer.parameters.empty() ? std::uint8_t{0} : answer.parameters.front();
  };
  switch (step_) {
    case Step::kPing:
      return enter(Step::kClearWatchdog, now_us);
    case Step::kClearWatchdog:
      return enter(Step::kTorqueOff, now_us);
    case Step::kTorqueOff:
      return enter(Step::kReadMode, now_us);
    case Step::kReadMode:
      return enter(
          value() == dynamixel_x::kPositionControl ? Step::kAcceleration : Step::kWriteMode,
          now_us);
    case Step::kWriteMode:
      return enter(Step::kAcceleration, now_us);
    case Step::kAcceleration:
      return enter(Step::kTorqueOn, now_us);
    case Step::kTorqueOn:
      return enter(Step::kWatchdog, now_us);
    case Step::kReadAlert:
      last_error_ = alert_text(value());
      return enter(Step::kReboot, now_us);
    case Step::kReboot:
      deadline_us_ = now_us + kRebootUs;
      return {};
    default:
      break;
  }
  ++counts_.connections;
  sync_.reset();
  tick_offset_us_.reset();
  move_pending_ = speed_rad_s_ > 0.0;
  next_reading_us_ = now_us;
  step_ = Step::kRun;
  return run(now_us);
}

bool DynamixelSession::has_restarted(const dynamixel_x::State& state, std::int64_t now_us) {
  // A servo that lost its supply for a moment answers as before, but has no torque: its clock
  // tells. Far more than any latency, less than any reset takes to go unnoticed.
  constexpr std::int64_t kJumpUs = 500'000;
  constexpr std::int64_t kWrapUs = 1000 * dynamixel_x::kTickWrap;
  const std::int64_t offset_us = now_us - 1000 * std::int64_t{state.tick_ms};
  const std::int64_t before_us = std::exchange(tick_offset_us_, offset_us).value_or(offset_us);
  const std::int64_t change_us = std::abs(offset_us - before_us) % kWrapUs;
  return std::min(change_us, kWrapUs - change_us) > kJumpUs;
}

std::optional<PitchSample> DynamixelSession::sample_of(const dynamixel_x::State& state,
                                                       std::int64_t first_byte_us) {
  // Any number may come over the line: the difference is taken in one that holds it.
  const std::int64_t steps = std::int64_t{state.position} - params_.dynamixel.level_position;
  if (std::abs(steps) > dynamixel_x::kStepsPerRevolution) {
    ++counts_.implausible;
    return std::nullopt;
  }
  ++counts_.samples;
  last_error_.clear();
  back_off_.succeeded();
  const double sign = params_.dynamixel.inverted ? -1.0 : 1.0;
  const std::int64_t measured_us =
      sync_.to_host_us(state.tick_ms, first_byte_us - kReturnDelayUs) + kHalfTickUs;
  return PitchSample{.time_us = std::min(measured_us, first_byte_us),
                     .pitch_rad = sign * dynamixel_x::kRadPerStep * static_cast<double>(steps),
                     .rate_rad_s = sign * dynamixel_x::kVelocityUnitRadS * state.velocity};
}

ServoOutput DynamixelSession::fail(std::string reason, std::int64_t now_us) {
  last_error_ = std::move(reason);
  step_ = Step::kWait;
  waiting_ = false;
  back_off_.failed(now_us);
  deadline_us_ = now_us + back_off_.wait_us(now_us);
  return {};
}

}  // namespace nodmap::laser3d
