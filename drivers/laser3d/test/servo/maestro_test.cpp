// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/servo/maestro.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "common/geometry/angle.hpp"
#include "drivers/laser3d/test/golden.hpp"

namespace nodmap::laser3d {
namespace maestro_test {

time::SteadyTime at(time::Duration since_start) {
  return time::SteadyTime(since_start);
}

using test::hex;

TEST(Maestro, CommandsAreAsInTheManual) {
  EXPECT_EQ(maestro::set_target(0, 1000.0), hex("84 00 20 1F"));
  EXPECT_EQ(maestro::set_target(0, 1500.0), hex("84 00 70 2E"));
  EXPECT_EQ(maestro::set_target(0, 2000.0), hex("84 00 40 3E"));
  EXPECT_EQ(maestro::get_position(3), hex("90 03"));
}

TEST(Maestro, SpeedIsNeverUnlimited) {
  EXPECT_EQ(maestro::set_speed(0, 0.0), hex("87 00 01 00"));
  EXPECT_EQ(maestro::set_speed(0, 3500.0), hex("87 00 0C 01"));  // 140 units
}

TEST(Maestro, ValuesStayInTheirFourteenBits) {
  EXPECT_EQ(maestro::set_target(0, -5.0), hex("84 00 00 00"));
  EXPECT_EQ(maestro::set_target(0, 1e9), hex("84 00 7F 7F"));
}

TEST(Maestro, PositionIsInQuarters) {
  EXPECT_DOUBLE_EQ(maestro::pulse_us_in(hex("70 17")), 1500.0);
}

// On channel 0: 1500 us looks straight ahead, 500 us less look up by 1 rad.
ServoParams params() {
  ServoParams params;
  params.id = 0;
  params.poll_hz = 100.0;
  params.maestro = {.level_us = 1500.0, .us_per_deg = geometry::deg_to_rad(-500.0)};
  return params;
}

Bytes answer(int quarter_us) {
  Bytes bytes;
  serial::append_little(bytes, static_cast<std::uint16_t>(quarter_us));
  return bytes;
}

TEST(MaestroSession, ReportsTheCommandedPitchAsSuch) {
  MaestroSession dut(params());
  EXPECT_FALSE(dut.measures_pitch());
  EXPECT_EQ(dut.open(at(0s)).send, hex("89 00 00 00"));
  EXPECT_EQ(dut.poll(at(0s)).send, hex("90 00"));
  const ServoOutput output = dut.receive(answer(4 * 1400), at(2ms));
  ASSERT_TRUE(output.sample);
  EXPECT_DOUBLE_EQ(output.sample->pitch_rad, 0.2);
  EXPECT_EQ(output.sample->stamp, at(1ms));
  EXPECT_TRUE(dut.is_running());
}

TEST(MaestroSession, ItsRateIsThatBetweenTwoReadings) {
  MaestroSession dut(params());
  EXPECT_FALSE(dut.open(at(0s)).send.empty());
  EXPECT_FALSE(dut.poll(at(0s)).send.empty());
  EXPECT_EQ(dut.receive(answer(4 * 1500), at(2ms)).sample->rate_rad_s, 0.0);
  EXPECT_FALSE(dut.poll(at(100ms)).send.empty());
  EXPECT_NEAR(dut.receive(answer(4 * 1400), at(102ms)).sample->rate_rad_s, 2.0, 1e-12);
}

TEST(MaestroSession, SpeedComesBeforeTheTarget) {
  MaestroSession dut(params());
  EXPECT_FALSE(dut.open(at(0s)).send.empty());
  dut.aim(-1.0, 7.0);
  EXPECT_EQ(dut.poll(at(0s)).send, hex("87 00 0C 01 84 00 40 3E 90 00"));
}

TEST(MaestroSession, SilenceIsAnErrorAndRequestsContinue) {
  MaestroSession dut(params());
  EXPECT_FALSE(dut.open(at(0s)).send.empty());
  int questions = 0;
  for (time::SteadyTime now; now < at(2s); now += 1ms) {
    questions += dut.poll(now).send.empty() ? 0 : 1;
  }
  EXPECT_FALSE(dut.is_running());
  EXPECT_EQ(dut.last_error(), "the servo controller does not answer");
  EXPECT_GT(questions, 4);
  EXPECT_LT(questions, 12);  // with growing pauses
}

TEST(MaestroSession, AnswersThatAreTooLongOrOffGiveNoPitch) {
  MaestroSession dut(params());
  EXPECT_FALSE(dut.open(at(0s)).send.empty());
  EXPECT_FALSE(dut.poll(at(0s)).send.empty());
  EXPECT_FALSE(dut.receive(hex("70 17 00"), at(1ms)).sample);
  EXPECT_FALSE(dut.poll(at(20ms)).send.empty());
  EXPECT_FALSE(dut.receive(answer(0), at(21ms)).sample);
}

// The session after it has received only this answer, for a second.
std::unique_ptr<MaestroSession> session_that_receives(const Bytes& bytes) {
  auto dut = std::make_unique<MaestroSession>(params());
  (void)dut->open(at(0s));
  for (time::SteadyTime now; now < at(1s); now += 1ms) {
    if (!dut->poll(now).send.empty()) {
      EXPECT_FALSE(dut->receive(bytes, now).sample);
    }
  }
  return dut;
}

TEST(MaestroSession, AControllerThatOnlySendsNonsenseDoesNotAnswer) {
  // Too long; and 6.4 radians from level.
  for (const Bytes& nonsense : {hex("70 17 00"), answer(4 * (1500 + 3200))}) {
    const auto dut = session_that_receives(nonsense);
    EXPECT_EQ(dut->last_error(), "the servo controller does not answer");
    EXPECT_GT(dut->line_counts().implausible, 4);
    EXPECT_LT(dut->line_counts().implausible, 12) << "with growing pauses";
  }
}

}  // namespace maestro_test
}  // namespace nodmap::laser3d
