// SPDX-License-Identifier: BSD-3-Clause
#include "procman/protocol/other_sheriffs.hpp"

#include <gtest/gtest.h>

namespace nodmap::procman {
namespace other_sheriffs_test {

constexpr bus::Sender kOne{0x7F000001, 40'000};
constexpr bus::Sender kOther{0x7F000001, 40'001};

time::SteadyTime at(time::Duration since_start) {
  return time::SteadyTime(100s + since_start);
}

TEST(OtherSheriffs, OneRunsThatRepeatsItsOrdersUntilItIsSilent) {
  OtherSheriffs sheriffs;
  EXPECT_FALSE(sheriffs.received(at(0s)));
  sheriffs.take("a", kOne, at(0s));
  EXPECT_EQ(sheriffs.received(at(0s)), "a");
  EXPECT_FALSE(sheriffs.running(at(0s)));
  sheriffs.take("a", kOne, at(1s));
  EXPECT_EQ(sheriffs.running(at(1s)), "a");
  EXPECT_EQ(sheriffs.running(at(4s)), "a");
  EXPECT_FALSE(sheriffs.running(at(4s + 1us)));
  EXPECT_FALSE(sheriffs.received(at(4s + 1us)));
  sheriffs.take("a", kOne, at(5s));
  EXPECT_FALSE(sheriffs.running(at(5s))) << "it has to repeat them again";
}

// One message, in one piece or in several, can be of anybody.
TEST(OtherSheriffs, ABurstIsNoRunningSheriff) {
  OtherSheriffs sheriffs;
  for (time::Duration since{}; since < OtherSheriffs::kRepeated; since += 10ms) {
    sheriffs.take("a", kOne, at(since));
  }
  EXPECT_FALSE(sheriffs.running(at(1s)));
}

TEST(OtherSheriffs, OrdersFromDifferentSocketsAreNotRepeated) {
  OtherSheriffs sheriffs;
  sheriffs.take("a", kOne, at(0s));
  sheriffs.take("a", kOther, at(1s));
  EXPECT_FALSE(sheriffs.running(at(1s)));
}

// Also from sockets without number.
TEST(OtherSheriffs, ARunningOneIsKnownAmongForgedOnes) {
  OtherSheriffs sheriffs;
  sheriffs.take("a", kOne, at(0s));
  for (std::uint16_t port = 1; port < 1000; ++port) {
    sheriffs.take("forged", {0x7F000001, port}, at(500ms));
  }
  sheriffs.take("a", kOne, at(1s));
  EXPECT_EQ(sheriffs.running(at(1s)), "a");
}

}  // namespace other_sheriffs_test
}  // namespace nodmap::procman
