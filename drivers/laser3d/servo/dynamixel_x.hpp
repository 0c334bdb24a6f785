// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/angle.hpp"
#include "drivers/laser3d/servo/dynamixel.hpp"

/// The part of the X series' control table (also MX with protocol 2.0) that this driver uses.
namespace nodmap::laser3d::dynamixel_x {

inline constexpr std::uint16_t kOperatingMode = 11;  // in EEPROM: written only if different
inline constexpr std::uint16_t kShutdown = 63;  // the hardware errors that switch the torque off
inline constexpr std::uint16_t kTorqueEnable = 64;
inline constexpr std::uint16_t kHardwareError = 70;
// In units of 20 ms; stops the servo if the host is silent.
inline constexpr std::uint16_t kBusWatchdog = 98;
inline constexpr std::uint16_t kProfileAcceleration = 108;
inline constexpr std::uint16_t kProfileVelocity = 112;  // followed by the goal position
inline constexpr std::uint16_t kRealtimeTick = 120;     // start of the state registers

inline constexpr std::uint8_t kPositionControl = 3;
inline constexpr std::int64_t kTickWrap = 32'768;  // milliseconds
inline constexpr std::int32_t kStepsPerRevolution = 4096;
inline constexpr double kRadPerStep = 2.0 * geometry::kPi / kStepsPerRevolution;
inline constexpr double kVelocityUnitRadS = 0.229 * 2.0 * geometry::kPi / 60.0;
inline constexpr double kAccelerationUnitRadS2 = 214.577 * 2.0 * geometry::kPi / 3600.0;

/// The content of registers 120 to 135, read at one moment.
struct State {
  std::uint16_t tick_ms = 0;
  std::int32_t velocity = 0;  ///< in units of 0.229 revolutions per minute
  std::int32_t position = 0;  ///< in units of 0.088 degrees; 2048 is the centre
};

[[nodiscard]] Bytes read_state(std::uint8_t id);
[[nodiscard]] std::optional<State> state_in(const DynamixelStatus& answer);

/// Hardware errors, as bits.
struct HardwareErrors {
  std::uint8_t present = 0;
  std::uint8_t switching_off = 0;  ///< those at which the servo switches its torque off
};

[[nodiscard]] Bytes read_hardware_errors(std::uint8_t id);
[[nodiscard]] std::optional<HardwareErrors> hardware_errors_in(const DynamixelStatus& answer);

/// Writes speed and goal in one request, so that no movement begins at the old speed. Sends a speed
/// of at least 1, because 0 would mean "as fast as possible".
[[nodiscard]] Bytes move_to(std::uint8_t id, std::int32_t position, double speed_rad_s);

[[nodiscard]] Bytes write_byte(std::uint8_t id, std::uint16_t address, std::uint8_t value);
/// Sends at least 1, because 0 would mean "unlimited".
[[nodiscard]] Bytes set_acceleration(std::uint8_t id, double acceleration_rad_s2);

}  // namespace nodmap::laser3d::dynamixel_x
