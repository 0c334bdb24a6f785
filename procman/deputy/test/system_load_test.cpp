// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/system_load.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

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
  SystemLoad load;
  load.sample({::getpid()});
  CommandStatus status;
  status.pid = ::getpid();
  load.describe_process(status);
  EXPECT_GT(status.rss_bytes, 100 * 1024) << "every program needs more";
  EXPECT_GT(status.vsize_bytes, status.rss_bytes);
  CommandStatus stopped;
  load.describe_process(stopped);
  EXPECT_EQ(stopped.rss_bytes, 0);
  DeputyInfo info;
  load.describe_host(info);
  EXPECT_GT(info.memory.total_bytes, info.memory.free_bytes);
  EXPECT_LT(info.cpu_load, 0.0F) << "not known from one sample";
}

}  // namespace system_load_test
}  // namespace nodmap::procman
