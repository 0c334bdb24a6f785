// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/servo/dynamixel_session.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace nodmap::laser3d {
namespace {

// Twice the default latency of a USB adapter (16 ms) and a reserve; the time for the bytes is
// added.
constexpr time::Duration kAnswerTimeout = 40ms;
constexpr double kBitsPerByte = 10.0;
constexpr double kSmallestAnswerBytes = 11.0;  // without parameters
constexpr int kMissesAllowed = 3;
constexpr time::Duration kRebootTime = 1s;
constexpr int kDamagedRequest = 3;          // error code: the servo's own check of the checksum
constexpr std::uint8_t kWatchdog20Ms = 10;  // 200 ms

// The servo reads its registers, waits for its return delay (factory setting) and sends the first
// byte.
constexpr time::Duration kReturnDelay = 500us;
// The servo counts whole milliseconds; on average half of one more has passed.
constexpr time::Duration kHalfTick = 500us;

// How often the errors are read while the servo continues in spite of one: another may be added.
constexpr time::Duration kAlertCheckPeriod = 200ms;

std::string names_of_errors(std::uint8_t bits) {
  std::string text;
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
      sync_({.tick = 1ms, .wrap_ticks = dynamixel_x::kTickWrap, .max_drift = 0.001}) {}

ServoOutput DynamixelSession::open(time::SteadyTime now) {
  last_error_ = "being started";
  parser_.reset(params_.baud);
  back_off_.succeeded();
  return enter(Step::kPing, now);
}

void DynamixelSession::close() {
  step_ = Step::kClosed;
  last_error_ = "not connected";
}

ServoCounts DynamixelSession::line_counts() const {
  ServoCounts counts = counts_;
  counts.checksum_errors = parser_.errors().checksum;
  return counts;
}

std::string DynamixelSession::warning() const {
  return warning_.empty() && sync_.delay() > 0us ? describe_delay(sync_.delay()) : warning_;
}

ServoOutput DynamixelSession::poll(time::SteadyTime now) {
  if (step_ == Step::kClosed) {
    return {};
  }
  if (is_waiting_) {
    if (now < deadline_) {
      return {};
    }
    ++counts_.unanswered;
    return missed(now);
  }
  if (step_ == Step::kRun) {
    return run(now);
  }
  // kReboot and kWait end when their time is over; every other step waits for an answer.
  return now < deadline_ ? ServoOutput{} : enter(Step::kPing, now);
}

ServoOutput DynamixelSession::receive(ByteView bytes, time::SteadyTime now) {
  parser_.feed(bytes, now);
  std::optional<ServoOutput> output;
  while (const auto answer = parser_.next()) {
    // Only one: what has arrived already cannot answer the request that is sent next.
    if (!output && is_waiting_ && is_expected(*answer)) {
      output = take(*answer, now);
    }
  }
  return output.value_or(ServoOutput{});
}

bool DynamixelSession::is_expected(const DynamixelStatus& answer) const {
  return answer.id == id_ &&
         (answer.error_code() != 0 || answer.parameters.size() == expected_parameters_);
}

ServoOutput DynamixelSession::run(time::SteadyTime now) {
  if (aim_.take()) {
    const double steps = (params_.dynamixel.inverted ? -aim_.goal_rad() : aim_.goal_rad()) /
                         dynamixel_x::kRadPerStep;
    const auto position =
        params_.dynamixel.level_position + static_cast<std::int32_t>(std::lround(steps));
    return ask(dynamixel_x::move_to(id_, position, aim_.speed_rad_s()), now);
  }
  if (now < next_reading_) {
    return {};
  }
  // Keeps the period, but does not catch up on readings that a busy line delayed.
  next_reading_ = std::max(next_reading_ + params_.period(), now);
  return ask(dynamixel_x::read_state(id_), now);
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
    case Step::kReboot:
      return dynamixel::reboot(id_);
    default:
      return {};
  }
}

ServoOutput DynamixelSession::enter(Step step, time::SteadyTime now) {
  step_ = step;
  misses_ = 0;
  return ask(request(), now);
}

ServoOutput DynamixelSession::ask(Bytes bytes, time::SteadyTime now) {
  is_waiting_ = !bytes.empty();
  expected_parameters_ = is_waiting_ ? dynamixel::num_answer_parameters(bytes) : 0;
  const double bits = kBitsPerByte * (static_cast<double>(bytes.size() + expected_parameters_) +
                                      kSmallestAnswerBytes);
  deadline_ = now + kAnswerTimeout + time::from_seconds(bits / params_.baud);
  return {.send = std::move(bytes), .sample = std::nullopt};
}

ServoOutput DynamixelSession::missed(time::SteadyTime now) {
  if (step_ == Step::kReboot) {
    is_waiting_ = false;  // its answer may be lost during the restart
    deadline_ = now + kRebootTime;
    return {};
  }
  if (++misses_ > kMissesAllowed) {
    return fail("the servo does not answer", now);
  }
  if (step_ == Step::kRun) {
    is_waiting_ = false;
    aim_.repeat();  // the lost request may have been a move
    return run(now);
  }
  return ask(request(), now);
}

ServoOutput DynamixelSession::take(const DynamixelStatus& answer, time::SteadyTime now) {
  is_waiting_ = false;
  if (answer.error_code() == kDamagedRequest) {
    ++counts_.damaged;
    return missed(now);  // the servo has done nothing, as if it had not received the request
  }
  misses_ = 0;
  if (const auto errors = dynamixel_x::hardware_errors_in(answer)) {
    return take(*errors, now);
  }
  if (!answer.hardware_alert()) {
    warning_.clear();
  } else if (now >= next_alert_check_ && step_ != Step::kReboot) {
    if (answer.error_code() != 0) {
      aim_.repeat();  // a move may have been refused
    }
    return ask(dynamixel_x::read_hardware_errors(id_), now);
  }
  if (answer.error_code() != 0) {
    return fail("the servo refuses a command (error " + std::to_string(answer.error_code()) + ")",
                now);
  }
  if (step_ != Step::kRun) {
    return advance(answer, now);
  }
  const std::optional<dynamixel_x::State> state = dynamixel_x::state_in(answer);
  if (!state) {
    return run(now);  // the answer to a move
  }
  if (watch_for_restart(*state, now)) {
    return fail("the servo has been restarted", now);
  }
  ServoOutput output = run(now);  // the line is free for a move
  output.sample = sample_of(*state, answer.first_byte);
  return output;
}

ServoOutput DynamixelSession::advance(const DynamixelStatus& answer, time::SteadyTime now) {
  const auto value = [&answer] {
    return answer.parameters.empty() ? std::uint8_t{0} : answer.parameters.front();
  };
  switch (step_) {
    case Step::kPing:
      return enter(Step::kClearWatchdog, now);
    case Step::kClearWatchdog:
      return enter(Step::kTorqueOff, now);
    case Step::kTorqueOff:
      return enter(Step::kReadMode, now);
    case Step::kReadMode:
      return enter(
          value() == dynamixel_x::kPositionControl ? Step::kAcceleration : Step::kWriteMode, now);
    case Step::kWriteMode:
      return enter(Step::kAcceleration, now);
    case Step::kAcceleration:
      return enter(Step::kTorqueOn, now);
    case Step::kTorqueOn:
      return enter(Step::kWatchdog, now);
    case Step::kReboot:
      deadline_ = now + kRebootTime;
      return {};
    default:
      break;
  }
  ++counts_.connections;
  sync_.reset();
  started_.reset();
  aim_.restart();
  next_reading_ = now;
  step_ = Step::kRun;
  return run(now);
}

ServoOutput DynamixelSession::take(const dynamixel_x::HardwareErrors& errors,
                                   time::SteadyTime now) {
  if ((errors.present & errors.switching_off) != 0) {
    ++counts_.shutdowns;
    last_error_ = "the servo switched itself off:" + names_of_errors(errors.present);
    return enter(Step::kReboot, now);
  }
  warning_ = "the servo reports a fault:" + names_of_errors(errors.present);
  next_alert_check_ = now + kAlertCheckPeriod;
  return step_ == Step::kRun ? run(now) : ask(request(), now);
}

bool DynamixelSession::watch_for_restart(const dynamixel_x::State& state, time::SteadyTime now) {
  // A servo whose supply failed for a moment answers as before, but has no torque. The jump of its
  // clock reveals it. The threshold is far above any latency.
  constexpr time::Duration kJump = 500ms;
  constexpr time::Duration kWrap = dynamixel_x::kTickWrap * 1ms;
  const time::SteadyTime started = now - std::chrono::milliseconds(state.tick_ms);
  const time::SteadyTime before = std::exchange(started_, started).value_or(started);
  const time::Duration change = std::chrono::abs(started - before) % kWrap;
  return std::min(change, kWrap - change) > kJump;
}

std::optional<PitchSample> DynamixelSession::sample_of(const dynamixel_x::State& state,
                                                       time::SteadyTime first_byte) {
  // The position may be any number, so the difference is computed in 64 bits.
  const std::int64_t steps = std::int64_t{state.position} - params_.dynamixel.level_position;
  if (std::abs(steps) > dynamixel_x::kStepsPerRevolution) {
    ++counts_.implausible;
    return std::nullopt;
  }
  last_error_.clear();
  back_off_.succeeded();
  const double sign = params_.dynamixel.inverted ? -1.0 : 1.0;
  const time::SteadyTime measured =
      sync_.to_host(state.tick_ms, first_byte - kReturnDelay) + kHalfTick;
  return PitchSample{.stamp = std::min(measured, first_byte),
                     .pitch_rad = sign * dynamixel_x::kRadPerStep * static_cast<double>(steps),
                     .rate_rad_s = sign * dynamixel_x::kVelocityUnitRadS * state.velocity};
}

ServoOutput DynamixelSession::fail(std::string reason, time::SteadyTime now) {
  last_error_ = std::move(reason);
  step_ = Step::kWait;
  is_waiting_ = false;
  back_off_.failed(now);
  deadline_ = now + back_off_.wait(now);
  return {};
}

}  // namespace nodmap::laser3d
