// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/system_load.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

namespace nodmap::procman {
namespace {

TEST(SystemLoad, ReadsTheFirstFourColumns) {
  const auto ticks = parse_cpu_ticks("cpu  10 20 30 940 5 6 7 8 9 10\ncpu0 1 2 3 4\n");
  ASSERT_TRUE(ticks.has_value());
  EXPECT_EQ(ticks->busy, 60U);
  EXPECT_EQ(ticks->total, 1000U);
  for (const char* text : {"", "cpu", "cpu  1 2 3", "cpu0 1 2 3 4", "cpu a b c d"}) {
    EXPECT_FALSE(parse_cpu_ticks(text).has_value()) << text;
  }
}

TEST(SystemLoad, ReadsMemoryLines) {
  const char* text = "MemTotal:       24000 kB\nMemFree:  1 kB\nSwapTotal:       0 kB";
  EXPECT_EQ(parse_memory_bytes(text, "MemTotal"), 24000 * 1024);
  EXPECT_EQ(parse_memory_bytes(text, "MemFree"), 1024);
  EXPECT_EQ(parse_memory_bytes(text, "SwapTotal"), 0);
  EXPECT_EQ(parse_memory_bytes(text, "Mem"), 0);
  EXPECT_EQ(parse_memory_bytes("", "MemFree"), 0);
}

TEST(SystemLoad, AShareIsBetweenZeroAndOne) {
  EXPECT_FLOAT_EQ(share_of(1, 4), 0.25F);
  EXPECT_FLOAT_EQ(share_of(0, 0), 0.0F);
  EXPECT_FLOAT_EQ(share_of(5, 4), 0.0F) << "counters that do not fit each other";
}

TEST(SystemLoad, KnowsTheMemoryOfThisProcess) {
  SystemLoad load;
  load.sample({::getpid()});
  CommandStatus status;
  status.pid = ::getpid();
  load.describe_process(status);
  EXPECT_GT(status.rss_bytes, 100 * 1024) << "no program is smaller";
  EXPECT_GT(status.vsize_bytes, status.rss_bytes);
  CommandStatus stopped;
  load.describe_process(stopped);
  EXPECT_EQ(stopped.rss_bytes, 0);
  DeputyInfo info;
  load.describe_host(info);
  EXPECT_GT(info.memory_total_bytes, info.memory_free_bytes);
  EXPECT_LT(info.cpu_load, 0.0F) << "not known from one sample";
}

}  // namespace
}  // namespace nodmap::procman
