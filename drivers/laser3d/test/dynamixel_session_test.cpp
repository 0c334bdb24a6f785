// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/dynamixel_session.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "drivers/laser3d/test/golden.hpp"

namespace nodmap::laser3d {
namespace {

using test::hex;
using test::operator+;

/// A servo with its registers, moving at the profile velocity; answers are built here, not with
/// the driver's encoders.
class FakeServo {
 public:
  std::array<std::uint8_t, 150> registers{};
  bool powered = true;
  bool alert = false;
  bool jammed = false;
  int booted_ms = 0;
  int mode_writes = 0;
  int reboots = 0;
  double position = 2048.0;

  void step_ms(int now_ms) {
    const double goal = read_i32(registers, 116);
    const double speed = jammed ? 0.0 : read_u32(registers, 112) * 0.229 / 60.0 * 4.096;
    position += std::clamp(goal - position, -speed, speed);
    put(120, static_cast<std::uint32_t>((now_ms - booted_ms) % 32'768), 2);
    put(132, static_cast<std::uint32_t>(std::lround(position)), 4);
  }

  Bytes answer(const Bytes& request) {
    if (!powered) {
      return {};
    }
    const std::uint8_t instruction = request[7];
    const std::size_t address = request.size() > 10 ? read_u16(request, 8) : 0;
    switch (instruction) {
      case 0x01:
        return status(hex("FC 03 26"));
      case 0x02: {
        const std::size_t count = read_u16(request, 10);
        return status(Bytes(registers.begin() + static_cast<std::ptrdiff_t>(address),
                            registers.begin() + static_cast<std::ptrdiff_t>(address + count)));
      }
      case 0x03:
        mode_writes += address == 11 ? 1 : 0;
        std::copy(request.begin() + 10, request.end() - 2,
                  registers.begin() + static_cast<std::ptrdiff_t>(address));
        return status({});
      case 0x08:
        ++reboots;
        alert = false;
        return status({});
      default:
        return {};
    }
  }

 private:
  Bytes status(const Bytes& parameters) const {
    Bytes bytes = hex("FF FF FD 00 01");
    append_u16(bytes, static_cast<std::uint16_t>(parameters.size() + 4));
    bytes.push_back(0x55);
    bytes.push_back(alert ? 0x80 : 0x00);
    bytes = bytes + parameters;
    append_u16(bytes, dynamixel_crc(bytes));
    return bytes;
  }

  void put(std::size_t at, std::uint32_t value, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      registers[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
    }
  }
};

class Rig {
 public:
  explicit Rig(const DynamixelSettings& settings = {}) : dut(settings) {
    servo.registers[11] = 3;
    for (std::size_t i = 0; i < 4; ++i) {  // the goal is where it stands
      servo.registers[116 + i] = static_cast<std::uint8_t>(2048U >> (8 * i));
    }
  }

  void open() { handle(dut.open(now_us)); }

  void run(double seconds) {
    const std::int64_t end_us = now_us + static_cast<std::int64_t>(1e6 * seconds);
    for (; now_us < end_us; now_us += 1000) {
      servo.step_ms(static_cast<int>(now_us / 1000));
      const Bytes arrived = std::exchange(on_the_line_, {});
      handle(dut.receive(arrived, now_us));
      handle(dut.poll(now_us));
    }
  }

  DynamixelSession dut;
  FakeServo servo;
  std::int64_t now_us = 0;
  std::vector<PitchSample> samples;

 private:
  void handle(const ServoOutput& output) {
    if (!output.send.empty()) {
      on_the_line_ = on_the_line_ + servo.answer(output.send);
    }
    if (output.sample) {
      samples.push_back(*output.sample);
    }
  }

  Bytes on_the_line_;
};

TEST(DynamixelSession, RunsAndTellsWhereItIs) {
  Rig rig;
  rig.open();
  rig.run(0.5);
  EXPECT_TRUE(rig.dut.running());
  EXPECT_GT(rig.samples.size(), 90U);  // every 5 ms
  EXPECT_EQ(rig.samples.back().pitch_rad, 0.0);
  EXPECT_EQ(rig.servo.registers[64], 1);   // torque
  EXPECT_EQ(rig.servo.registers[98], 10);  // watchdog, 200 ms
}

TEST(DynamixelSession, MovesAtTheSpeedAsked) {
  Rig rig;
  rig.open();
  rig.run(0.5);
  rig.dut.aim(0.5, 1.0);
  rig.run(0.25);
  EXPECT_NEAR(rig.samples.back().pitch_rad, 0.25, 0.03);  // a few ms of delay at 1 rad/s
  rig.run(1.0);
  EXPECT_NEAR(rig.samples.back().pitch_rad, 0.5, dynamixel_x::kRadPerStep);
}

TEST(DynamixelSession, AnInvertedServoLooksUpForSmallerPositions) {
  DynamixelSettings settings;
  settings.inverted = true;
  Rig rig(settings);
  rig.open();
  rig.run(0.1);
  rig.dut.aim(0.5, 2.0);
  rig.run(1.0);
  EXPECT_LT(rig.servo.position, 2048.0);
  EXPECT_NEAR(rig.samples.back().pitch_rad, 0.5, dynamixel_x::kRadPerStep);
}

TEST(DynamixelSession, TheModeIsWrittenOnlyIfItDiffers) {
  Rig same;
  same.open();
  same.run(0.3);
  EXPECT_EQ(same.servo.mode_writes, 0);
  Rig other;
  other.servo.registers[11] = 4;
  other.open();
  other.run(0.3);
  EXPECT_EQ(other.servo.mode_writes, 1);
  EXPECT_TRUE(other.dut.running());
}

TEST(DynamixelSession, ALostServoIsNoticedAndFoundAgain) {
  Rig rig;
  rig.open();
  rig.run(0.3);
  rig.servo.powered = false;
  rig.run(0.2);  // four times 40 ms without an answer
  EXPECT_FALSE(rig.dut.running());
  EXPECT_EQ(rig.dut.trouble(), "the servo does not answer");
  rig.run(20.0);
  rig.servo.powered = true;
  rig.run(6.0);  // the longest back-off is 5 s
  EXPECT_TRUE(rig.dut.running());
  EXPECT_EQ(rig.dut.counts().connections, 2);
}

TEST(DynamixelSession, AnAlertIsToldAndTheServoRestarted) {
  Rig rig;
  rig.open();
  rig.run(0.3);
  rig.servo.registers[70] = 0x20;
  rig.servo.alert = true;
  rig.run(0.1);
  EXPECT_FALSE(rig.dut.running());
  EXPECT_EQ(rig.dut.trouble(), "the servo switched itself off: overload");
  rig.run(2.0);
  EXPECT_EQ(rig.servo.reboots, 1);
  EXPECT_TRUE(rig.dut.running());
}

TEST(DynamixelSession, AfterARestartItGoesOnToItsGoal) {
  Rig rig;
  rig.open();
  rig.run(0.1);
  rig.dut.aim(0.4, 2.0);
  rig.run(1.0);
  rig.servo = FakeServo();
  rig.servo.registers[11] = 3;
  rig.servo.booted_ms = static_cast<int>(rig.now_us / 1000);  // without torque, but answering
  rig.run(2.0);
  EXPECT_NEAR(rig.samples.back().pitch_rad, 0.4, 0.01);
}

TEST(DynamixelSession, SamplesAreStampedWithinAMillisecond) {
  Rig rig;
  rig.open();
  rig.run(0.2);
  rig.dut.aim(1.0, 1.0);
  rig.run(0.6);
  // The fake moves at 0.9992 rad/s (42 units of 0.229 rpm would be 1.007) in steps of 1 ms and
  // answers 1 ms after it was read: pitch and stamp must lie on one line.
  const PitchSample& a = rig.samples[rig.samples.size() - 60];
  const PitchSample& b = rig.samples.back();
  const double rate =
      1e6 * (b.pitch_rad - a.pitch_rad) / static_cast<double>(b.time_us - a.time_us);
  EXPECT_NEAR(rate, 1.007, 0.02);  // 1 ms and one step of 0.088 degrees in 0.3 s
}

}  // namespace
}  // namespace nodmap::laser3d
