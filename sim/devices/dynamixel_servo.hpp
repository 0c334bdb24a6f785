// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "common/geometry/time.hpp"
#include "sim/body/robot_model.hpp"
#include "sim/devices/dynamixel_packet.hpp"
#include "sim/devices/dynamixel_registers.hpp"
#include "sim/devices/serial_device.hpp"

namespace nodmap::sim {

struct DynamixelParams {
  std::uint8_t id = 1;
  int baud = 1'000'000;
  int level_position = 2048;
  bool inverted = false;
  double boot_s = 0.3;
  double clock_ppm = 30.0;
  bool echo = false;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("servo_clock_ppm", clock_ppm, {-2000.0, 2000.0},
             "Error of the servo's clock; positive: too fast.");
    v.integer("servo_level_position", level_position, {0, 4095},
              "Position of the servo at which the laser looks straight ahead.");
    v.flag("servo_inverted", inverted, "Let larger positions of the servo look down.");
    v.flag("servo_echo", echo, "Let the servo's adapter echo the host's bytes.");
  }
};

/// The pitch servo: a Dynamixel of the X series, protocol 2.0. Only position control works; other
/// operating modes can be set but do nothing.
class DynamixelServo final : public SerialDevice {
 public:
  DynamixelServo(const DynamixelParams& params, RobotModel& model, time::SteadyTime power_on = {});

  void receive(ByteView bytes, int baud, time::SteadyTime now) override;
  void transmit(time::SteadyTime now, int baud, Bytes& line) override;
  [[nodiscard]] time::SteadyTime next_due() const override;

  /// Switches the servo off with these error bits (register 70) until it is restarted.
  void raise_hardware_error(std::uint8_t bits);

 private:
  void update(time::SteadyTime now);
  void handle(const DynamixelInstruction& instruction, time::SteadyTime now);
  [[nodiscard]] DynamixelError execute(const DynamixelInstruction& instruction,
                                       time::SteadyTime now, Bytes& values);
  [[nodiscard]] DynamixelError write(ByteView parameters, time::SteadyTime now);
  void restart(time::SteadyTime now);
  void measure(time::SteadyTime now);
  void move();
  void set_torque(bool on);
  [[nodiscard]] std::int32_t position() const;

  DynamixelParams params_;
  RobotModel& model_;
  DynamixelRegisters registers_;
  DynamixelReader reader_;
  SerialOutput output_;
  time::SteadyTime booted_{};
  time::SteadyTime last_instruction_{};
};

}  // namespace nodmap::sim
