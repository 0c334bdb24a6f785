// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/system_load.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <vector>

namespace nodmap::procman {
namespace system_load_test {

TEST(SystemLoad, ReadsMemoryLines) {
  const char* text = "MemTotal:       24000 kB\nMemFree:  1 kB\nSwapTotal:       0 kB";
  EXPECT_EQ(parse_memory_bytes(text, "MemTotal"), 24000 * 1024);
  EXPECT_EQ(parse_memory_bytes(text, "MemFree"), 1024);
  EXPECT_EQ(parse_memory_bytes(text, "SwapTotal"), 0);
  EXPECT_EQ(parse_memory_bytes(text, "Mem"), 0);
  EXPECT_EQ(parse_memory_bytes("", "MemFree"), 0);
}

TEST(SystemLoad, ReportsTheMemoryOfThisProcess) {
  constexpr std::int64_t kMib = 1 << 20;
  SystemLoad load;
  CommandStatus status;
  status.pid = ::getpid();
  load.sample({::getpid()});
  load.describe_process(status);
  DeputyInfo info;
  load.describe_host(info);
  const std::int64_t before_bytes = status.rss_bytes;
  const std::vector<char> block(64 * kMib, 'x');
  load.sample({::getpid()});
  load.describe_process(status);
  EXPECT_EQ(block.back(), 'x');  // so that no compiler omits it
  // The kernel counts a thread's pages in batches of 64. AddressSanitizer takes an eighth more.
  EXPECT_GE(status.rss_bytes - before_bytes, 63 * kMib);
  EXPECT_LE(status.rss_bytes - before_bytes, 74 * kMib);
  EXPECT_GT(status.vsize_bytes, status.rss_bytes);
  CommandStatus stopped;
  load.describe_process(stopped);
  EXPECT_EQ(stopped.rss_bytes, 0);
  EXPECT_GT(info.memory.total_bytes, info.memory.free_bytes);
  EXPECT_LT(info.cpu_load, 0.0F) << "not known from one sample";
}

}  // namespace system_load_test
}  // namespace nodmap::procman
