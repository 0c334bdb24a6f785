// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/arrival_clock.hpp"

#include <gtest/gtest.h>

#include "common/bus/followed_sender.hpp"

namespace nodmap::bus {
namespace arrival_clock_test {

constexpr time::Timestamp kWall{1'700'000'000s};
constexpr time::SteadyTime kSteady{5h};

// The same moment by both clocks, `passed` after the start.
time::Moment moment(time::Duration passed) {
  return {kWall + passed, kSteady + passed};
}

TEST(ArrivalClock, DatagramsThatWaitedAreDatedWhenTheyCame) {
  ArrivalClock dut(kSteady);
  dut.begin(moment(500ms));
  EXPECT_EQ(dut.arrival(kWall + 10ms), kSteady + 10ms);
  EXPECT_EQ(dut.arrival(kWall + 480ms), kSteady + 480ms);
  // Received between the reading of the clock and that of the socket.
  EXPECT_EQ(dut.arrival(kWall + 501ms), kSteady + 500ms);
}

// More waited than are read at a time.
TEST(ArrivalClock, TheNextReadContinuesAtTheSameDate) {
  ArrivalClock dut(kSteady);
  dut.begin(moment(500ms));
  EXPECT_EQ(dut.arrival(kWall + 10ms), kSteady + 10ms);
  dut.begin(moment(501ms));
  EXPECT_EQ(dut.arrival(kWall + 20ms), kSteady + 20ms);
}

TEST(ArrivalClock, AClockThatIsSetMovesNothingOutOfTheWait) {
  for (const time::Duration set_by : {-1h, 1h}) {
    ArrivalClock dut(kSteady - 1h);
    dut.begin(moment(0s));
    dut.drained();
    dut.begin({kWall + 500ms + set_by, kSteady + 500ms});
    const time::SteadyTime before = dut.arrival(kWall + 100ms);
    const time::SteadyTime after = dut.arrival(kWall + 200ms + set_by);
    EXPECT_GE(before, kSteady);
    EXPECT_LE(before, after);
    EXPECT_LE(after, kSteady + 500ms);
    dut.drained();
    dut.begin({kWall + 900ms + set_by, kSteady + 900ms});
    EXPECT_EQ(dut.arrival(kWall + 800ms + set_by), kSteady + 800ms) << "the next wait is right";
  }
}

// Frozen for 300 ms, longer than a sender may be silent; both have sent on, the other first.
TEST(ArrivalClock, AFrozenProcessGoesOnFollowingItsSender) {
  constexpr Sender kOne{0x7F000001, 40'000};
  constexpr Sender kOther{0x7F000001, 40'001};
  ArrivalClock dut(kSteady);
  FollowedSender followed(200ms);
  ASSERT_TRUE(followed.follow(kOne, kSteady));
  dut.begin(moment(300ms));
  for (time::Duration sent = 5ms; sent < 300ms; sent += 10ms) {
    EXPECT_FALSE(followed.follow(kOther, dut.arrival(kWall + sent)));
    EXPECT_TRUE(followed.follow(kOne, dut.arrival(kWall + sent + 5ms)));
  }
}

}  // namespace arrival_clock_test
}  // namespace nodmap::bus
