// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/dynamixel_x.hpp"

#include <gtest/gtest.h>

#include "drivers/laser3d/test/golden.hpp"

namespace nodmap::laser3d {
namespace {

using test::hex;

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

TEST(DynamixelX, ZeroWouldBeWithoutLimitAndIsNeverSent) {
  const Bytes move = dynamixel_x::move_to(1, 2048, 0.0);
  EXPECT_EQ(read_u32(move, 10), 1U);
  const Bytes acceleration = dynamixel_x::set_acceleration(1, 0.0);
  EXPECT_EQ(read_u32(acceleration, 10), 1U);
}

}  // namespace
}  // namespace nodmap::laser3d
