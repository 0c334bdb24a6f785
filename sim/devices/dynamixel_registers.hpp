// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/devices/dynamixel_packet.hpp"
#include "sim/devices/serial_device.hpp"

namespace nodmap::sim {

/// Addresses in the control table of the X series (ROBOTIS e-manual, XM540-W270).
namespace dynamixel_register {
inline constexpr std::uint16_t kModel = 0;
inline constexpr std::uint16_t kFirmware = 6;
inline constexpr std::uint16_t kId = 7;
inline constexpr std::uint16_t kReturnDelay = 9;
inline constexpr std::uint16_t kOperatingMode = 11;
inline constexpr std::uint16_t kMovingThreshold = 24;
inline constexpr std::uint16_t kMaxPosition = 48;
inline constexpr std::uint16_t kMinPosition = 52;
inline constexpr std::uint16_t kTorqueEnable = 64;
inline constexpr std::uint16_t kStatusReturnLevel = 68;
inline constexpr std::uint16_t kHardwareError = 70;
inline constexpr std::uint16_t kBusWatchdog = 98;
inline constexpr std::uint16_t kGoalPwm = 100;
inline constexpr std::uint16_t kProfileAcceleration = 108;
inline constexpr std::uint16_t kProfileVelocity = 112;
inline constexpr std::uint16_t kGoalPosition = 116;
inline constexpr std::uint16_t kRealtimeTick = 120;
inline constexpr std::uint16_t kMoving = 122;
inline constexpr std::uint16_t kPresentVelocity = 128;
inline constexpr std::uint16_t kPresentPosition = 132;
inline constexpr std::uint16_t kVelocityTrajectory = 136;
inline constexpr std::uint16_t kPositionTrajectory = 140;
inline constexpr std::uint16_t kVoltage = 144;
inline constexpr std::uint16_t kTemperature = 146;
}  // namespace dynamixel_register

/// The control table: registers and their access rights. Addresses up to 63 are EEPROM, which
/// survives a restart and is locked while the torque is on.
class DynamixelRegisters {
 public:
  static constexpr std::size_t kSize = 147;

  DynamixelRegisters();

  /// Reads a register as a two's complement number; `address` is its start.
  [[nodiscard]] std::int32_t get(std::uint16_t address) const;
  void set(std::uint16_t address, std::int32_t value);

  /// A write instruction: whole registers only, all or nothing.
  [[nodiscard]] DynamixelError write(std::uint16_t address, ByteView values);
  /// Any bytes of the table, including those between registers.
  [[nodiscard]] DynamixelError read(std::uint16_t address, std::size_t count, Bytes& values) const;

  /// Resets everything above the EEPROM to its state after power-on.
  void restart();

 private:
  [[nodiscard]] DynamixelError check(std::uint16_t address, std::size_t size,
                                     std::int64_t value) const;

  std::array<std::uint8_t, kSize> bytes_{};
};

}  // namespace nodmap::sim
