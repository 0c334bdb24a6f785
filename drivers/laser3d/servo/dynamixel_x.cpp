// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/servo/dynamixel_x.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace nodmap::laser3d::dynamixel_x {
namespace {

constexpr std::uint16_t kStateBytes = 16;
// From kShutdown to kHardwareError. No other answer has this length.
constexpr std::uint16_t kErrorBytes = kHardwareError - kShutdown + 1;
constexpr double kMaxProfileValue = 32'767.0;

std::uint32_t profile_value(double value, double unit) {
  return static_cast<std::uint32_t>(std::lround(std::clamp(value / unit, 1.0, kMaxProfileValue)));
}

}  // namespace

Bytes read_state(std::uint8_t id) {
  return dynamixel::read(id, kRealtimeTick, kStateBytes);
}

std::optional<State> state_in(const DynamixelStatus& answer) {
  constexpr std::size_t kVelocityAt = 128 - kRealtimeTick;
  constexpr std::size_t kPositionAt = 132 - kRealtimeTick;
  if (answer.parameters.size() != kStateBytes) {
    return std::nullopt;
  }
  State state;
  state.tick_ms = boost::endian::load_little_u16(answer.parameters.data());
  state.velocity = boost::endian::load_little_s32(&answer.parameters[kVelocityAt]);
  state.position = boost::endian::load_little_s32(&answer.parameters[kPositionAt]);
  if (state.tick_ms >= kTickWrap) {
    return std::nullopt;
  }
  return state;
}

Bytes read_hardware_errors(std::uint8_t id) {
  return dynamixel::read(id, kShutdown, kErrorBytes);
}

std::optional<HardwareErrors> hardware_errors_in(const DynamixelStatus& answer) {
  if (answer.parameters.size() != kErrorBytes) {
    return std::nullopt;
  }
  return HardwareErrors{.present = answer.parameters.back(),
                        .switching_off = answer.parameters.front()};
}

Bytes move_to(std::uint8_t id, std::int32_t position, double speed_rad_s) {
  Bytes values;
  serial::append_little(values, profile_value(speed_rad_s, kVelocityUnitRadS));
  serial::append_little(values, static_cast<std::uint32_t>(position));
  return dynamixel::write(id, kProfileVelocity, values);
}

Bytes write_byte(std::uint8_t id, std::uint16_t address, std::uint8_t value) {
  return dynamixel::write(id, address, std::array{value});
}

Bytes set_acceleration(std::uint8_t id, double acceleration_rad_s2) {
  Bytes values;
  serial::append_little(values, profile_value(acceleration_rad_s2, kAccelerationUnitRadS2));
  return dynamixel::write(id, kProfileAcceleration, values);
}

}  // namespace nodmap::laser3d::dynamixel_x
