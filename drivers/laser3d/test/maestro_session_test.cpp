// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/maestro_session.hpp"

#include <gtest/gtest.h>

#include "drivers/laser3d/test/golden.hpp"

namespace nodmap::laser3d {
namespace {

using test::hex;

Bytes answer(int quarter_us) {
  Bytes bytes;
  append_u16(bytes, static_cast<std::uint16_t>(quarter_us));
  return bytes;
}

TEST(MaestroSession, TellsTheCommandedPitchAndSaysSo) {
  MaestroSession dut({.channel = 0, .level_pulse_us = 1500.0, .pulse_us_per_rad = -500.0});
  EXPECT_FALSE(dut.measures_pitch());
  EXPECT_EQ(dut.open(0).send, hex("89 00 00 00"));
  EXPECT_EQ(dut.poll(0).send, hex("90 00"));
  const ServoOutput output = dut.receive(answer(4 * 1400), 2000);
  ASSERT_TRUE(output.sample);
  EXPECT_DOUBLE_EQ(output.sample->pitch_rad, 0.2);
  EXPECT_EQ(output.sample->time_us, 1000);
  EXPECT_TRUE(dut.running());
}

TEST(MaestroSession, SpeedComesBeforeTheTarget) {
  MaestroSession dut({.channel = 0, .level_pulse_us = 1500.0, .pulse_us_per_rad = -500.0});
  EXPECT_FALSE(dut.open(0).send.empty());
  dut.aim(-1.0, 7.0);
  EXPECT_EQ(dut.poll(0).send, hex("87 00 0C 01 84 00 40 3E 90 00"));
}

TEST(MaestroSession, SilenceIsTroubleAndIsAskedOn) {
  MaestroSession dut({});
  EXPECT_FALSE(dut.open(0).send.empty());
  int questions = 0;
  for (std::int64_t now_us = 0; now_us < 2'000'000; now_us += 1000) {
    questions += dut.poll(now_us).send.empty() ? 0 : 1;
  }
  EXPECT_FALSE(dut.running());
  EXPECT_EQ(dut.trouble(), "the servo controller does not answer");
  EXPECT_GT(questions, 4);
  EXPECT_LT(questions, 12);  // with growing pauses
}

TEST(MaestroSession, AnswersThatAreTooLongOrOffAreNoPitch) {
  MaestroSession dut({});
  EXPECT_FALSE(dut.open(0).send.empty());
  EXPECT_FALSE(dut.poll(0).send.empty());
  EXPECT_FALSE(dut.receive(hex("70 17 00"), 1000).sample);
  EXPECT_FALSE(dut.poll(20'000).send.empty());
  EXPECT_FALSE(dut.receive(answer(0), 21'000).sample);
}

}  // namespace
}  // namespace nodmap::laser3d
