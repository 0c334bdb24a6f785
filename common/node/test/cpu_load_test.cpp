// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/cpu_load.hpp"

#include <gtest/gtest.h>

namespace nodmap::node {
namespace cpu_load_test {

TEST(CpuLoad, ReadsTheFirstFourColumns) {
  const auto ticks = parse_cpu_ticks("cpu  10 20 30 940 5 6 7 8 9 10\ncpu0 1 2 3 4\n");
  ASSERT_TRUE(ticks.has_value());
  EXPECT_EQ(ticks->busy, 60U);
  EXPECT_EQ(ticks->total, 1000U);
  for (const char* text : {"", "cpu", "cpu  1 2 3", "cpu0 1 2 3 4", "cpu a b c d"}) {
    EXPECT_FALSE(parse_cpu_ticks(text).has_value()) << text;
  }
}

TEST(CpuLoad, AShareIsBetweenZeroAndOne) {
  EXPECT_FLOAT_EQ(share_of(1, 4), 0.25F);
  EXPECT_FLOAT_EQ(share_of(0, 0), 0.0F);
  EXPECT_FLOAT_EQ(share_of(5, 4), 0.0F) << "counters that do not fit each other";
}

TEST(CpuLoad, IsThatBetweenTheLastTwoSamples) {
  CpuLoad load;
  EXPECT_LT(load.share(), 0.0F);
  load.take(CpuTicks{100, 200});
  EXPECT_LT(load.share(), 0.0F) << "not known from one sample";
  load.take(CpuTicks{130, 240});
  EXPECT_FLOAT_EQ(load.share(), 0.75F);
  EXPECT_EQ(load.elapsed_ticks(), 40U);
  load.take(CpuTicks{10, 20});
  EXPECT_EQ(load.elapsed_ticks(), 0U) << "the counters restarted";
  load.take(std::nullopt);
  load.take(CpuTicks{20, 40});
  EXPECT_EQ(load.elapsed_ticks(), 0U) << "after a sample that could not be read";
}

}  // namespace cpu_load_test
}  // namespace nodmap::node
