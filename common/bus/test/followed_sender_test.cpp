// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/followed_sender.hpp"

#include <gtest/gtest.h>

namespace nodmap::bus {
namespace followed_sender_test {

constexpr Sender kOne{0x7F000001, 40'000};
constexpr Sender kOther{0x7F000001, 40'001};

TEST(FollowedSender, AnotherOneIsFollowedWhenTheFirstIsSilent) {
  FollowedSender sender(1s);
  EXPECT_TRUE(sender.follow(kOne, {}));
  EXPECT_FALSE(sender.follow(kOther, time::SteadyTime{999ms}));
  EXPECT_TRUE(sender.follow(kOne, time::SteadyTime{999ms}));
  EXPECT_FALSE(sender.follow(kOther, time::SteadyTime{1s})) << "the refused message does not count";
  EXPECT_TRUE(sender.follow(kOther, time::SteadyTime{1999ms}));
  EXPECT_FALSE(sender.follow(kOne, time::SteadyTime{2s}));
}

TEST(FollowedSender, AnotherOneIsFollowedWhenTheFirstHasEnded) {
  FollowedSender sender(1s);
  EXPECT_TRUE(sender.follow(kOne, {}));
  EXPECT_FALSE(sender.end(kOther));
  EXPECT_FALSE(sender.follow(kOther, {}));
  EXPECT_TRUE(sender.end(kOne));
  EXPECT_FALSE(sender.end(kOne));
  EXPECT_TRUE(sender.follow(kOther, {}));
}

TEST(FollowedSender, AClockThatIsSetBackForgets) {
  FollowedSender sender(1s);
  EXPECT_TRUE(sender.follow(kOne, time::SteadyTime{1h}));
  EXPECT_TRUE(sender.follow(kOther, {}));
}

}  // namespace followed_sender_test
}  // namespace nodmap::bus
