// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/maestro.hpp"

#include <gtest/gtest.h>

#include <array>

#include "drivers/laser3d/test/golden.hpp"

namespace nodmap::laser3d {
namespace {

using test::hex;

TEST(Maestro, CommandsAreAsInTheManual) {
  EXPECT_EQ(maestro::set_target(0, 1000.0), hex("84 00 20 1F"));
  EXPECT_EQ(maestro::set_target(0, 1500.0), hex("84 00 70 2E"));
  EXPECT_EQ(maestro::set_target(0, 2000.0), hex("84 00 40 3E"));
  EXPECT_EQ(maestro::get_position(3), hex("90 03"));
  EXPECT_EQ(maestro::get_errors(), hex("A1"));
  EXPECT_EQ(maestro::go_home(), hex("A2"));
  EXPECT_EQ(maestro::addressed(12, maestro::set_target(0, 1500.0)), hex("AA 0C 04 00 70 2E"));
  EXPECT_EQ(maestro::crc7(hex("83 01")), 0x17);
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

}  // namespace
}  // namespace nodmap::laser3d
