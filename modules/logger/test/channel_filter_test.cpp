// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/channel_filter.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "common/node/program.hpp"

namespace nodmap::logger {
namespace channel_filter_test {

TEST(ChannelFilter, MatchesWholeNames) {
  ChannelFilter filter("SCAN|POSE_.*", "");
  EXPECT_TRUE(filter.wants("SCAN"));
  EXPECT_TRUE(filter.wants("POSE_2D"));
  EXPECT_FALSE(filter.wants("SCAN_RAW"));
  EXPECT_FALSE(filter.wants("MY_SCAN"));
  EXPECT_FALSE(filter.wants("SCAN_RAW")) << "the second time the answer is remembered";
}

TEST(ChannelFilter, ExclusionWins) {
  ChannelFilter filter(".*", "CLOUD|LCM_.*");
  EXPECT_TRUE(filter.wants("SCAN"));
  EXPECT_FALSE(filter.wants("CLOUD"));
  EXPECT_FALSE(filter.wants("LCM_SELF_TEST"));
}

TEST(ChannelFilter, HandlesManyNamesAndUnusualOnes) {
  ChannelFilter filter("SCAN", "");
  for (int i = 0; i < 3000; ++i) {
    EXPECT_FALSE(filter.wants("NOISE_" + std::to_string(i)));
    EXPECT_LE(filter.num_remembered(), 1000U) << "random names must not fill the memory";
  }
  EXPECT_FALSE(filter.wants(""));
  EXPECT_FALSE(filter.wants(std::string("SCAN\0", 5)));
  EXPECT_TRUE(filter.wants("SCAN"));
}

TEST(ChannelFilter, AnInvalidExpressionIsNamed) {
  try {
    const ChannelFilter filter(".*", "A(");
    FAIL();
  } catch (const node::UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("'A('"), std::string::npos);
  }
}

}  // namespace channel_filter_test
}  // namespace nodmap::logger
