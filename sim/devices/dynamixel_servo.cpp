// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/dynamixel_servo.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/angle.hpp"
#include "sim/devices/serial_device.hpp"

namespace nodmap::sim {
namespace {

using namespace dynamixel_register;  // NOLINT(google-build-using-namespace): the register names

constexpr double kRadPerStep = 2.0 * geometry::kPi / 4096.0;
constexpr double kRpm = 2.0 * geometry::kPi / 60.0;
constexpr double kVelocityUnitRadS = 0.229 * kRpm;
constexpr double kAccelerationUnitRadS2 = 214.577 * kRpm / 60.0;
constexpr time::Duration kWatchdogUnit = 20ms;
constexpr std::int32_t kWatchdogFired = 0xFF;

constexpr std::uint8_t kPing = 0x01;
constexpr std::uint8_t kRead = 0x02;
constexpr std::uint8_t kWrite = 0x03;
constexpr std::uint8_t kReboot = 0x08;

}  // namespace

DynamixelServo::DynamixelServo(const DynamixelParams& params, RobotModel& model,
                               time::SteadyTime power_on)
    : params_(params), model_(model) {
  registers_.set(kId, params.id);
  restart(power_on);
}

void DynamixelServo::restart(time::SteadyTime now) {
  registers_.restart();
  booted_ = now + time::from_seconds(params_.boot_s);
  model_.set_pitch_torque(false);
}

void DynamixelServo::receive(ByteView bytes, int baud, time::SteadyTime now) {
  update(now);
  if (params_.echo) {
    output_.send({bytes.begin(), bytes.end()}, baud, now);
  }
  if (now < booted_) {
    return;
  }
  reader_.feed(received_bytes(params_.baud, bytes, baud), now);
  while (const auto instruction = reader_.next()) {
    handle(*instruction, now);
  }
}

void DynamixelServo::transmit(time::SteadyTime now, int baud, Bytes& line) {
  update(now);
  output_.take(now, baud, line);
}

time::SteadyTime DynamixelServo::next_due() const {
  const std::int32_t watchdog = registers_.get(kBusWatchdog);
  const bool watched = watchdog > 0 && watchdog != kWatchdogFired;
  return std::min(output_.next_due(),
                  watched ? last_instruction_ + kWatchdogUnit * watchdog : kNever);
}

// The bus watchdog: without instructions the servo stops.
void DynamixelServo::update(time::SteadyTime now) {
  const std::int32_t watchdog = registers_.get(kBusWatchdog);
  if (watchdog > 0 && watchdog != kWatchdogFired &&
      now >= last_instruction_ + kWatchdogUnit * watchdog) {
    registers_.set(kBusWatchdog, kWatchdogFired);
    registers_.set(kGoalPosition, position());
    move();
  }
}

void DynamixelServo::handle(const DynamixelInstruction& instruction, time::SteadyTime now) {
  const auto id = static_cast<std::uint8_t>(registers_.get(kId));
  const bool for_all = instruction.id == kDynamixelBroadcast;
  if (instruction.id != id && !for_all) {
    return;
  }
  last_instruction_ = now;
  const time::Duration delay = 2us * registers_.get(kReturnDelay);
  const std::int32_t level = registers_.get(kStatusReturnLevel);
  Bytes values;
  const DynamixelError error =
      instruction.is_damaged ? DynamixelError::kChecksum : execute(instruction, now, values);
  const bool answers = instruction.code == kPing ||
                       (!for_all && (level == 2 || (level == 1 && instruction.code == kRead)));
  if (answers) {
    const bool alert = registers_.get(kHardwareError) != 0;
    output_.send(dynamixel_status(id, error, alert, values), params_.baud, now + delay);
  }
}

DynamixelError DynamixelServo::execute(const DynamixelInstruction& instruction,
                                       time::SteadyTime now, Bytes& values) {
  const ByteView parameters = instruction.parameters;
  switch (instruction.code) {
    case kPing:
      append_little_endian(values, static_cast<std::uint32_t>(registers_.get(kModel)), 2);
      values.push_back(static_cast<std::uint8_t>(registers_.get(kFirmware)));
      return DynamixelError::kNone;
    case kRead:
      if (parameters.size() != 4) {
        return DynamixelError::kLength;
      }
      measure(now);
      return registers_.read(static_cast<std::uint16_t>(little_endian(parameters.first(2))),
                             little_endian(parameters.last(2)), values);
    case kWrite:
      return write(parameters, now);
    case kReboot:
      restart(now);
      return DynamixelError::kNone;
    default:
      return DynamixelError::kInstruction;
  }
}

DynamixelError DynamixelServo::write(ByteView parameters, time::SteadyTime now) {
  if (parameters.size() < 3) {
    return DynamixelError::kLength;
  }
  const auto address = static_cast<std::uint16_t>(little_endian(parameters.first(2)));
  const ByteView bytes = parameters.subspan(2);
  const std::size_t end = address + bytes.size();
  if (registers_.get(kBusWatchdog) == kWatchdogFired && address < kRealtimeTick && end > kGoalPwm) {
    return DynamixelError::kRange;  // goals can be read only until the watchdog is cleared
  }
  const bool torque_before = registers_.get(kTorqueEnable) != 0;
  measure(now);
  const DynamixelError error = registers_.write(address, bytes);
  if (error != DynamixelError::kNone) {
    return error;
  }
  const bool torque = registers_.get(kTorqueEnable) != 0;
  if (torque != torque_before) {
    set_torque(torque);
  }
  if (address <= kGoalPosition && end > kGoalPosition) {
    move();
  }
  return error;
}

void DynamixelServo::set_torque(bool on) {
  if (on && registers_.get(kHardwareError) != 0) {
    registers_.set(kTorqueEnable, 0);
    return;
  }
  model_.set_pitch_torque(on);
  if (on) {  // the servo holds its present position
    registers_.set(kGoalPosition, position());
    move();
  }
}

void DynamixelServo::raise_hardware_error(std::uint8_t bits) {
  registers_.set(kHardwareError, bits);
  registers_.set(kTorqueEnable, 0);
  model_.set_pitch_torque(false);
}

void DynamixelServo::move() {
  const double sign = params_.inverted ? -1.0 : 1.0;
  const std::int32_t steps = registers_.get(kGoalPosition) - params_.level_position;
  model_.set_pitch_goal(
      {.pitch_rad = sign * kRadPerStep * steps,
       .speed_rad_s = kVelocityUnitRadS * registers_.get(kProfileVelocity),
       .acceleration_rad_s2 = kAccelerationUnitRadS2 * registers_.get(kProfileAcceleration)});
}

std::int32_t DynamixelServo::position() const {
  const double sign = params_.inverted ? -1.0 : 1.0;
  return params_.level_position +
         static_cast<std::int32_t>(std::lround(sign * model_.pitch_rad() / kRadPerStep));
}

void DynamixelServo::measure(time::SteadyTime now) {
  const double sign = params_.inverted ? -1.0 : 1.0;
  const auto velocity =
      static_cast<std::int32_t>(std::lround(sign * model_.pitch_rate_rad_s() / kVelocityUnitRadS));
  const time::FineDuration running =
      time::FineDuration(now - booted_) * (1.0 + 1e-6 * params_.clock_ppm);
  registers_.set(kRealtimeTick, static_cast<std::int32_t>(
                                    static_cast<std::int64_t>(1e-3 * running.count()) % 32'768));
  registers_.set(kPresentPosition, position());
  registers_.set(kPresentVelocity, velocity);
  // The trajectory inside the servo is not modelled; its registers show the present state.
  registers_.set(kPositionTrajectory, position());
  registers_.set(kVelocityTrajectory, velocity);
  registers_.set(kMoving, std::abs(velocity) > registers_.get(kMovingThreshold) ? 1 : 0);
}

}  // namespace nodmap::sim
