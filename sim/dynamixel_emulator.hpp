// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sim/device.hpp"
#include "sim/dynamixel_packet.hpp"
#include "sim/dynamixel_registers.hpp"
#include "sim/plant.hpp"
#include "sim/serial_output.hpp"

namespace nodmap::sim {

struct DynamixelSettings {
  std::uint8_t id = 1;
  int baud = 1'000'000;
  std::int32_t level_position = 2048;  ///< where the laser looks straight ahead
  bool inverted = false;               ///< larger positions look down
  double boot_s = 0.3;
  double clock_ppm = 30.0;  ///< by how much its clock goes too fast
  bool echo = false;        ///< the adapter gives the host's own bytes back
};

/// The pitch servo: a Dynamixel of the X series, protocol 2.0, on the plant's pitch axis. Position
/// control; other operating modes can be set and do nothing.
class DynamixelEmulator : public Device {
 public:
  DynamixelEmulator(const DynamixelSettings& settings, Plant& plant, std::int64_t power_on_us = 0);

  void receive(std::span<const std::uint8_t> bytes, int baud, std::int64_t now_us) override;
  void transmit(std::int64_t now_us, int baud, std::vector<std::uint8_t>& line) override;
  [[nodiscard]] std::int64_t next_us() const override;

  /// The servo switches itself off for this reason (register 70) until it is restarted.
  void raise_hardware_error(std::uint8_t bits);

 private:
  void settle(std::int64_t now_us);
  void obey(const DynamixelInstruction& instruction, std::int64_t now_us);
  [[nodiscard]] DynamixelError carry_out(const DynamixelInstruction& instruction,
                                         std::int64_t now_us, Bytes& values);
  [[nodiscard]] DynamixelError write(ByteView parameters, std::int64_t now_us);
  void restart(std::int64_t now_us);
  void measure(std::int64_t now_us);
  void move();
  void set_torque(bool on);
  [[nodiscard]] std::int32_t position() const;

  DynamixelSettings settings_;
  Plant& plant_;
  DynamixelRegisters registers_;
  DynamixelReader reader_;
  SerialOutput output_;
  std::int64_t booted_us_ = 0;
  std::int64_t heard_us_ = 0;  // the last instruction
};

}  // namespace nodmap::sim
