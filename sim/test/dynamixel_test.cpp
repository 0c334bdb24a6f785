// SPDX-License-Identifier: BSD-3-Clause
// Packets as the vendor documents them, or as an independent script computed them from its rules;
// tests send instructions and check the answers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/angle.hpp"
#include "sim/devices/dynamixel_servo.hpp"
#include "sim/test/host.hpp"

namespace nodmap::sim {
namespace dynamixel_test {

using test::hex;
using test::Host;
using ::testing::ElementsAreArray;
using ::testing::IsEmpty;

const Bytes kOk = hex("FF FF FD 00 01 04 00 55 00 A1 0C");
const Bytes kPing = hex("FF FF FD 00 01 03 00 01 19 4E");
const Bytes kPingAnswer = hex("FF FF FD 00 01 07 00 55 00 FC 03 26 2E C3");
const Bytes kTorqueOn = hex("FF FF FD 00 01 06 00 03 40 00 01 DB 66");
const Bytes kTorqueOff = hex("FF FF FD 00 01 06 00 03 40 00 00 DE E6");
const Bytes kPositionMode = hex("FF FF FD 00 01 06 00 03 0B 00 03 48 E3");
const Bytes kReadPosition = hex("FF FF FD 00 01 07 00 02 84 00 04 00 1D 15");
const Bytes kAtLevel = hex("FF FF FD 00 01 08 00 55 00 00 08 00 00 1C 38");
const Bytes kGoalMinusOne = hex("FF FF FD 00 01 09 00 03 74 00 FF FF FF FF C8 89");

constexpr time::Duration kBootTime = 500ms;
constexpr time::Duration kAnswerTime = 5ms;

// Any instruction, with its checksum. Its bytes must not need stuffing.
Bytes instruction(std::uint8_t code, const Bytes& parameters, std::uint8_t id = 1) {
  Bytes bytes = hex("FF FF FD 00");
  bytes.push_back(id);
  append_little_endian(bytes, static_cast<std::uint32_t>(parameters.size() + 3), 2);
  bytes.push_back(code);
  append(bytes, parameters);
  append_little_endian(bytes, dynamixel_checksum(bytes), 2);
  return bytes;
}

Bytes write_u32(std::uint16_t address, std::uint32_t value) {
  Bytes parameters;
  append_little_endian(parameters, address, 2);
  append_little_endian(parameters, value, 4);
  return instruction(0x03, parameters);
}

int error_of(const Bytes& answer) {
  return answer.size() > 8 ? answer[8] : -1;
}

TEST(DynamixelPacket, AStatusPacketIsAsInTheManual) {
  EXPECT_THAT(dynamixel_status(1, DynamixelError::kNone, false, {}), ElementsAreArray(kOk));
  EXPECT_THAT(dynamixel_status(1, DynamixelError::kNone, false, hex("00 08 00 00")),
              ElementsAreArray(kAtLevel));
  EXPECT_THAT(dynamixel_status(1, DynamixelError::kNone, false, hex("A6 00 00 00")),
              ElementsAreArray(hex("FF FF FD 00 01 08 00 55 00 A6 00 00 00 8C C0")));
}

TEST(DynamixelPacket, BytesLikeAHeaderAreStuffed) {
  const Bytes status = dynamixel_status(1, DynamixelError::kNone, false, hex("FF FF FD 07"));
  EXPECT_EQ(status[5], 9);
  EXPECT_THAT(Bytes(status.begin() + 9, status.begin() + 14),
              ElementsAreArray(hex("FF FF FD FD 07")));
  DynamixelReader reader;
  reader.feed(hex("FF FF FD 00 01 0A 00 03 74 00 FF FF FD FD 00 21 E7"), {});
  const auto instruction = reader.next();
  ASSERT_TRUE(instruction.has_value());
  EXPECT_FALSE(instruction->is_damaged);
  EXPECT_THAT(instruction->parameters, ElementsAreArray(hex("74 00 FF FF FD 00")));
}

TEST(DynamixelPacket, AnInstructionIsFoundInNoiseAndInPieces) {
  DynamixelReader reader;
  reader.feed(hex("12 FF FF FF FD 01 FF FF"), {});
  EXPECT_FALSE(reader.next().has_value());
  reader.feed(hex("FD 00 01 03 00 01 19"), {});
  EXPECT_FALSE(reader.next().has_value());
  reader.feed(hex("4E"), {});
  const auto instruction = reader.next();
  ASSERT_TRUE(instruction.has_value());
  EXPECT_EQ(instruction->code, 0x01);
  EXPECT_FALSE(instruction->is_damaged);
}

// One whose length was damaged would swallow all that follow.
TEST(DynamixelPacket, AnIncompletePacketIsGivenUpAfterATenthOfASecond) {
  DynamixelReader reader;
  constexpr time::SteadyTime kBegin{1s};
  reader.feed(hex("FF FF FD 00 01 43 00 01 19"), kBegin);
  reader.feed(kPing, kBegin + 100ms);
  EXPECT_FALSE(reader.next().has_value());
  reader.feed(kPing, kBegin + 201ms);
  EXPECT_TRUE(reader.next().has_value());
}

// The servo on a bench: there is nothing in the world but the floor.
class DynamixelTest : public ::testing::Test {
 protected:
  explicit DynamixelTest(const DynamixelParams& params = {})
      : servo_(params, model_), host_(servo_, params.baud) {
    host_.before_each([this](time::SteadyTime now) { model_.advance_to(now); });
    host_.bytes_for(kBootTime);
  }

  Bytes ask(const Bytes& bytes) { return host_.ask(bytes, kAnswerTime); }

  std::uint32_t read(std::uint16_t address, std::uint16_t count) {
    Bytes parameters;
    append_little_endian(parameters, address, 2);
    append_little_endian(parameters, count, 2);
    const Bytes answer = ask(instruction(0x02, parameters));
    EXPECT_EQ(error_of(answer), 0);
    return answer.size() < 9U + count ? 0 : little_endian(ByteView(answer).subspan(9, count));
  }

  void start() {
    for (const Bytes& bytes : {kPositionMode, kTorqueOn}) {
      EXPECT_THAT(ask(bytes), ElementsAreArray(kOk));
    }
  }

  RobotModel model_{World{}, {}, 1};
  DynamixelServo servo_;
  Host host_;
};

TEST_F(DynamixelTest, AnswersAreAsInTheManual) {
  EXPECT_THAT(ask(kPing), ElementsAreArray(kPingAnswer));
  EXPECT_THAT(ask(kPositionMode), ElementsAreArray(kOk));
  EXPECT_THAT(ask(kTorqueOn), ElementsAreArray(kOk));
  EXPECT_THAT(ask(kReadPosition), ElementsAreArray(kAtLevel));
  EXPECT_THAT(ask(hex("FF FF FD 00 01 09 00 03 70 00 14 00 00 00 E2 79")), ElementsAreArray(kOk));
  EXPECT_THAT(ask(hex("FF FF FD 00 01 09 00 03 74 00 00 08 00 00 42 89")), ElementsAreArray(kOk));
  EXPECT_THAT(ask(hex("FF FF FD 00 01 0D 00 03 70 00 14 00 00 00 00 08 00 00 1A 87")),
              ElementsAreArray(kOk));
  EXPECT_THAT(ask(hex("FF FF FD 00 01 06 00 03 62 00 0A 4A E4")), ElementsAreArray(kOk));
  EXPECT_EQ(ask(hex("FF FF FD 00 01 07 00 02 7A 00 19 00 36 C3")).size(), 11U + 25U);
}

TEST_F(DynamixelTest, WaitsItsReturnDelayBeforeItAnswers) {
  host_.send(kPing);
  const auto portions = host_.portions_until(host_.now() + kAnswerTime);
  ASSERT_EQ(portions.size(), 1U);
  // 500 us, the default, and 14 bytes of 10 us.
  EXPECT_EQ(portions[0].received, test::at(kBootTime + 500us + 140us));
}

TEST_F(DynamixelTest, MovesAtTheRateOfItsProfile) {
  start();
  // 60 units of 0.229 rpm are 1.439 rad/s; 40 degrees up are 455 steps.
  EXPECT_THAT(ask(write_u32(112, 60)), ElementsAreArray(kOk));
  EXPECT_THAT(ask(write_u32(116, 2048 + 455)), ElementsAreArray(kOk));
  host_.bytes_for(200ms);
  EXPECT_GT(model_.pitch_rad(), 0.0) << "larger positions look up";
  EXPECT_EQ(read(122, 1), 1U) << "moving";
  EXPECT_NEAR(read(128, 4), 60.0, 2.0) << "rounding of rate and register";
  host_.bytes_for(1s);
  EXPECT_EQ(read(122, 1), 0U);
  EXPECT_NEAR(read(132, 4), 2048.0 + 455.0, 1.0) << "a step";
  EXPECT_NEAR(model_.pitch_rad(), geometry::deg_to_rad(40.0), 2.0 * geometry::kPi / 4096.0);
}

TEST_F(DynamixelTest, ItsClockCountsMilliseconds) {
  const std::uint32_t first = read(120, 2);
  host_.bytes_for(1s - kAnswerTime);
  EXPECT_NEAR(read(120, 2), first + 1000.0, 1.0) << "a millisecond may begin in between";
  host_.bytes_for(32'768ms - 1s - kAnswerTime);
  EXPECT_NEAR(read(120, 2), first, 3.0)
      << "it wraps at 32768 ms; a drift of 30 ppm is 1 ms in 33 s";
}

TEST_F(DynamixelTest, MemoryIsLockedWhileTheTorqueIsOn) {
  start();
  EXPECT_EQ(error_of(ask(kPositionMode)), 7);
  ask(kTorqueOff);
  EXPECT_EQ(error_of(ask(kPositionMode)), 0);
}

TEST_F(DynamixelTest, RefusalsHaveTheRightErrorNumber) {
  start();
  EXPECT_EQ(error_of(ask(kGoalMinusOne)), 6) << "beyond the limits of the position";
  EXPECT_EQ(error_of(ask(hex("FF FF FD 00 01 0A 00 03 74 00 FF FF FD FD 00 21 E7"))), 6);
  EXPECT_EQ(error_of(ask(write_u32(132, 0))), 7) << "the present position is read only";
  EXPECT_EQ(error_of(ask(instruction(0x03, hex("74 00 00 08")))), 5) << "half a register";
  EXPECT_EQ(error_of(ask(instruction(0x03, hex("42 00 01")))), 7) << "there is no register";
  EXPECT_EQ(error_of(ask(instruction(0x02, hex("90 00 10 00")))), 4) << "beyond the table";
  EXPECT_EQ(error_of(ask(instruction(0x04, {}))), 2);
  Bytes damaged = kPing;
  damaged.back() ^= 1;
  EXPECT_EQ(error_of(ask(damaged)), 3);
  EXPECT_THAT(ask(instruction(0x01, {}, 2)), IsEmpty()) << "another servo";
}

TEST_F(DynamixelTest, AnswersOnlyWhatItsReturnLevelAllows) {
  ask(instruction(0x03, hex("44 00 01")));  // reads only
  EXPECT_THAT(ask(kTorqueOn), IsEmpty());
  EXPECT_EQ(read(64, 1), 1U) << "but done";
  ask(instruction(0x03, hex("44 00 00")));
  EXPECT_THAT(ask(kReadPosition), IsEmpty());
  EXPECT_FALSE(ask(kPing).empty());
}

TEST_F(DynamixelTest, TheWatchdogStopsTheHeadWhenInstructionsStop) {
  start();
  ask(write_u32(112, 20));
  ask(hex("FF FF FD 00 01 06 00 03 62 00 0A 4A E4"));  // 200 ms
  ask(write_u32(116, 2048 + 600));
  host_.bytes_for(190ms);
  EXPECT_GT(model_.pitch_rate_rad_s(), 0.1);
  host_.bytes_for(200ms);
  EXPECT_NEAR(model_.pitch_rate_rad_s(), 0.0, 1e-6);
  EXPECT_EQ(read(98, 1), 0xFFU);
  EXPECT_EQ(error_of(ask(write_u32(116, 2048))), 4) << "goals are locked";
  EXPECT_EQ(error_of(ask(instruction(0x03, hex("62 00 00")))), 0);
  EXPECT_EQ(error_of(ask(write_u32(116, 2048))), 0);
}

TEST_F(DynamixelTest, AnAlertEndsOnlyWithARestart) {
  start();
  servo_.raise_hardware_error(0x20);
  EXPECT_EQ(error_of(ask(kReadPosition)), 0x80);
  EXPECT_EQ(error_of(ask(kTorqueOn)), 0x80);
  ask(kReadPosition);
  EXPECT_EQ(ask(hex("FF FF FD 00 01 03 00 08 2F 4E")).size(), kOk.size());
  EXPECT_THAT(ask(kPing), IsEmpty()) << "no answer during the restart";
  host_.bytes_for(kBootTime);
  EXPECT_THAT(ask(kPing), ElementsAreArray(kPingAnswer));
  EXPECT_EQ(read(64, 1), 0U) << "the torque is off";
  EXPECT_EQ(read(11, 1), 3U) << "its memory is unchanged";
}

TEST_F(DynamixelTest, AtAnotherBaudRateItReceivesOnlyNoise) {
  host_.set_baud(57'600);
  EXPECT_THAT(ask(kPing), IsEmpty());
}

class InvertedDynamixelTest : public DynamixelTest {
 protected:
  InvertedDynamixelTest() : DynamixelTest({.inverted = true, .echo = true}) {}
};

TEST_F(InvertedDynamixelTest, LargerPositionsLookDownAndRequestsAreEchoed) {
  const Bytes received = ask(kPing);
  EXPECT_THAT(Bytes(received.begin(), received.begin() + 10), ElementsAreArray(kPing));
  EXPECT_THAT(Bytes(received.begin() + 10, received.end()), ElementsAreArray(kPingAnswer));
  ask(kTorqueOn);
  ask(write_u32(116, 2048 + 200));
  host_.bytes_for(1s);
  // Rounding: the servo moves in whole steps.
  EXPECT_NEAR(model_.pitch_rad(), -200.0 * 2.0 * geometry::kPi / 4096.0, 1e-9);
}

}  // namespace dynamixel_test
}  // namespace nodmap::sim
