// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/senders.hpp"

#include <gtest/gtest.h>

namespace nodmap::procman {
namespace senders_test {

constexpr bus::Sender kOwn{0x7f000001, 1000};
constexpr bus::Sender kOther{0x7f000001, 1001};

Discovery discovery_of(const std::string& id, std::int64_t nonce) {
  Discovery discovery;
  discovery.transmitter_id = id;
  discovery.nonce = nonce;
  return discovery;
}

TEST(Senders, KnowTheirOwnDiscoveryByNameAndNonce) {
  Senders senders("robot", 7);
  EXPECT_TRUE(senders.take_own(discovery_of("robot", 7), kOwn));
  EXPECT_FALSE(senders.take_own(discovery_of("robot", 8), kOwn));
  EXPECT_FALSE(senders.take_own(discovery_of("base", 7), kOwn));
}

TEST(Senders, NobodyIsAnImpostorBeforeTheOwnSocketIsKnown) {
  Senders senders("robot", 7);
  EXPECT_FALSE(senders.is_impostor(kOther));
  EXPECT_FALSE(senders.take_own(discovery_of("robot", 8), kOther));  // tells nothing about ours
  EXPECT_FALSE(senders.is_impostor(kOther));
}

TEST(Senders, ACopyOfTheOwnDiscoveryDoesNotReplaceTheOwnSocket) {
  Senders senders("robot", 7);
  EXPECT_TRUE(senders.take_own(discovery_of("robot", 7), kOwn));
  EXPECT_TRUE(senders.take_own(discovery_of("robot", 7), kOther));
  EXPECT_FALSE(senders.is_impostor(kOwn));
  EXPECT_TRUE(senders.is_impostor(kOther));
}

TEST(Senders, AnotherSheriffIsFollowedOnceTheFirstHasEndedOrIsSilent) {
  Senders senders("robot", 7);
  const time::SteadyTime start{1s};
  EXPECT_TRUE(senders.follow_sheriff(kOwn, start));
  EXPECT_FALSE(senders.follow_sheriff(kOther, start + 1s));
  EXPECT_FALSE(senders.end_sheriff(kOther));
  EXPECT_FALSE(senders.follow_sheriff(kOther, start + Senders::kSheriffSilence - 1ms));
  EXPECT_TRUE(senders.follow_sheriff(kOther, start + Senders::kSheriffSilence));
  EXPECT_TRUE(senders.end_sheriff(kOther));
  EXPECT_TRUE(senders.follow_sheriff(kOwn, start + Senders::kSheriffSilence));
}

}  // namespace senders_test
}  // namespace nodmap::procman
