// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/servo/dynamixel.hpp"

#include <gtest/gtest.h>

#include <random>

#include "drivers/laser3d/servo/dynamixel_x.hpp"
#include "drivers/laser3d/test/golden.hpp"

namespace nodmap::laser3d {
namespace dynamixel_test {

using test::hex;
using test::operator+;  // NOLINT(misc-unused-using-decls): an operator is used

const Bytes kWriteOk = hex("FF FF FD 00 01 04 00 55 00 A1 0C");
const Bytes kPingReply = hex("FF FF FD 00 01 07 00 55 00 FC 03 26 2E C3");
const Bytes kPosition2048 = hex("FF FF FD 00 01 08 00 55 00 00 08 00 00 1C 38");
const Bytes kPosition166 = hex("FF FF FD 00 01 08 00 55 00 A6 00 00 00 8C C0");

std::vector<DynamixelStatus> parse(const Bytes& bytes) {
  DynamixelParser dut(1'000'000);
  dut.feed(bytes, {});
  std::vector<DynamixelStatus> answers;
  while (auto answer = dut.next()) {
    answers.push_back(std::move(*answer));
  }
  return answers;
}

TEST(Dynamixel, InstructionsAreAsInTheManual) {
  EXPECT_EQ(dynamixel::ping(1), hex("FF FF FD 00 01 03 00 01 19 4E"));
  EXPECT_EQ(dynamixel::reboot(1), hex("FF FF FD 00 01 03 00 08 2F 4E"));
  EXPECT_EQ(dynamixel::read(1, 132, 4), hex("FF FF FD 00 01 07 00 02 84 00 04 00 1D 15"));
  EXPECT_EQ(dynamixel::read(1, 122, 25), hex("FF FF FD 00 01 07 00 02 7A 00 19 00 36 C3"));
  EXPECT_EQ(dynamixel_x::read_state(1), hex("FF FF FD 00 01 07 00 02 78 00 10 00 35 5D"));
}

TEST(Dynamixel, TheNumberOfParametersInAnAnswerIsKnown) {
  using dynamixel::num_answer_parameters;
  EXPECT_EQ(num_answer_parameters(dynamixel::ping(1)), parse(kPingReply).at(0).parameters.size());
  EXPECT_EQ(num_answer_parameters(dynamixel::read(1, 132, 4)), 4U);
  EXPECT_EQ(num_answer_parameters(dynamixel_x::write_byte(1, 64, 1)), 0U);
  EXPECT_EQ(num_answer_parameters(dynamixel::reboot(1)), 0U);
}

TEST(Dynamixel, WritesAreAsInTheManual) {
  using dynamixel_x::write_byte;
  EXPECT_EQ(write_byte(1, 64, 1), hex("FF FF FD 00 01 06 00 03 40 00 01 DB 66"));
  EXPECT_EQ(write_byte(1, 64, 0), hex("FF FF FD 00 01 06 00 03 40 00 00 DE E6"));
  EXPECT_EQ(write_byte(1, 11, 3), hex("FF FF FD 00 01 06 00 03 0B 00 03 48 E3"));
  EXPECT_EQ(write_byte(1, 98, 10), hex("FF FF FD 00 01 06 00 03 62 00 0A 4A E4"));
  EXPECT_EQ(dynamixel::write(1, 112, hex("14 00 00 00")),
            hex("FF FF FD 00 01 09 00 03 70 00 14 00 00 00 E2 79"));
  EXPECT_EQ(dynamixel::write(1, 116, hex("00 08 00 00")),
            hex("FF FF FD 00 01 09 00 03 74 00 00 08 00 00 42 89"));
  EXPECT_EQ(dynamixel::write(1, 116, hex("00 02 00 00")),
            hex("FF FF FD 00 01 09 00 03 74 00 00 02 00 00 CA 89"));
  EXPECT_EQ(dynamixel::write(1, 116, hex("FF FF FF FF")),
            hex("FF FF FD 00 01 09 00 03 74 00 FF FF FF FF C8 89"));
  EXPECT_EQ(dynamixel_x::move_to(1, 2048, 20 * 0.229 * 2 * 3.14159265358979 / 60),
            hex("FF FF FD 00 01 0D 00 03 70 00 14 00 00 00 00 08 00 00 1A 87"));
}

TEST(Dynamixel, BytesLikeAHeaderAreStuffed) {
  EXPECT_EQ(dynamixel::write(1, 116, hex("FF FF FD 00")),
            hex("FF FF FD 00 01 0A 00 03 74 00 FF FF FD FD 00 21 E7"));
}

TEST(Dynamixel, AnswersAreAsInTheManual) {
  const auto ping = parse(kPingReply);
  ASSERT_EQ(ping.size(), 1U);
  EXPECT_EQ(ping[0].id, 1);
  EXPECT_EQ(ping[0].parameters, hex("FC 03 26"));  // model 1020, firmware 26h
  ASSERT_EQ(parse(kWriteOk).size(), 1U);
  EXPECT_TRUE(parse(kWriteOk)[0].parameters.empty());
  EXPECT_EQ(boost::endian::load_little_s32(parse(kPosition2048).at(0).parameters.data()), 2048);
  EXPECT_EQ(boost::endian::load_little_s32(parse(kPosition166).at(0).parameters.data()), 166);
}

TEST(Dynamixel, StuffedAnswersAreUnstuffed) {
  Bytes answer = hex("FF FF FD 00 01 09 00 55 00 FF FF FD FD 07");
  serial::append_little(answer, dynamixel_crc(answer));
  ASSERT_EQ(parse(answer).size(), 1U);
  EXPECT_EQ(parse(answer)[0].parameters, hex("FF FF FD 07"));
}

TEST(Dynamixel, OurOwnEchoIsSkipped) {
  EXPECT_EQ(parse(dynamixel_x::read_state(1) + kPosition2048).size(), 1U);
}

TEST(Dynamixel, AnswersAreFoundInNoiseAndInPiecesOfAnySize) {
  std::mt19937 random(3);
  std::uniform_int_distribution<> byte(0, 255);
  for (int run = 0; run < 200; ++run) {
    Bytes stream;
    for (int i = 0; i < 40; ++i) {
      stream.push_back(static_cast<std::uint8_t>(byte(random)));
    }
    stream = stream + hex("FF FF FF FD") + kPosition166 + hex("FF FF FD 00 01") + kPingReply +
             Bytes(140, 0x00);
    DynamixelParser dut(57'600);
    int answers = 0;
    for (std::size_t at = 0; at < stream.size(); at += 7) {
      dut.feed(ByteView(stream).subspan(at, std::min<std::size_t>(7, stream.size() - at)), {});
      while (dut.next()) {
        ++answers;
      }
    }
    EXPECT_EQ(answers, 2) << run;
  }
}

TEST(Dynamixel, EverySingleWrongByteIsNoticed) {
  for (std::size_t at = 0; at < kPosition166.size(); ++at) {
    Bytes damaged = kPosition166;
    damaged[at] ^= 0x10;
    EXPECT_TRUE(parse(damaged).empty()) << at;
  }
}

TEST(Dynamixel, ErrorByte) {
  Bytes answer = hex("FF FF FD 00 01 04 00 55 87");
  serial::append_little(answer, dynamixel_crc(answer));
  ASSERT_EQ(parse(answer).size(), 1U);
  EXPECT_EQ(parse(answer)[0].error_code(), 7);
  EXPECT_TRUE(parse(answer)[0].hardware_alert());
}

TEST(DynamixelX, StateOfOneMoment) {
  DynamixelStatus answer;
  answer.parameters = hex("E8 03 01 00 00 00 00 00 FB FF FF FF 00 08 00 00");
  const auto state = dynamixel_x::state_in(answer);
  ASSERT_TRUE(state);
  EXPECT_EQ(state->tick_ms, 1000);
  EXPECT_EQ(state->velocity, -5);
  EXPECT_EQ(state->position, 2048);
}

TEST(DynamixelX, OtherAnswersAreNoState) {
  EXPECT_FALSE(dynamixel_x::state_in({}));
  DynamixelStatus impossible;
  impossible.parameters = hex("FF FF 00x14");  // the tick counts to 32767
  EXPECT_FALSE(dynamixel_x::state_in(impossible));
}

TEST(DynamixelX, ZeroMeansUnlimitedAndIsNeverSent) {
  const Bytes move = dynamixel_x::move_to(1, 2048, 0.0);
  EXPECT_EQ(boost::endian::load_little_u32(&move[10]), 1U);
  const Bytes acceleration = dynamixel_x::set_acceleration(1, 0.0);
  EXPECT_EQ(boost::endian::load_little_u32(&acceleration[10]), 1U);
}

}  // namespace dynamixel_test
}  // namespace nodmap::laser3d
