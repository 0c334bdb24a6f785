// SPDX-License-Identifier: BSD-3-Clause
#include "bench/live/process_load.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <sstream>

namespace nodmap::bench {
namespace process_load_test {

TEST(ProcessLoad, IsParsedAfterANameWithBracketsAndBlanks) {
  const std::string stat =
      "42 (a ) b (c) S 1 42 42 0 -1 4194560 100 0 0 0 250 50 7 7 20 0 3 0 1000 123456789 512 "
      "18446744073709551615 1";
  const auto load = parse_load(stat, 0.01, 4096.0);
  ASSERT_TRUE(load);
  EXPECT_DOUBLE_EQ(load->cpu_s, 3.0);
  EXPECT_DOUBLE_EQ(load->resident_mib, 2.0);
}

TEST(ProcessLoad, OfAMalformedLineOrAMissingProcessIsNothing) {
  EXPECT_FALSE(parse_load("", 0.01, 4096.0));
  EXPECT_FALSE(parse_load("42 (short) S 1 42", 0.01, 4096.0));
  EXPECT_FALSE(
      parse_load("42 (x) S 1 42 42 0 -1 4194560 100 0 0 0 many 50 7 7 20 0 3 0 1000 123456789 512",
                 0.01, 4096.0));
  EXPECT_FALSE(read_load(-1));
}

TEST(ProcessLoad, OfThisProcessHasMemory) {
  const auto load = read_load(::getpid());
  ASSERT_TRUE(load);
  EXPECT_GT(load->resident_mib, 0.1);
}

TEST(UdpQueues, AreSummedOverAllSockets) {
  std::istringstream table(
      "   sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout "
      "inode ref pointer drops\n"
      "  100: EF4C43EF:1DF3 00000000:0000 07 00000000:00000A00 00:00000000 00000000     0        0 "
      "1234 2 0000000000000000 3\n"
      "  101: EF4C43EF:1DF3 00000000:0000 07 00000000:00000100 00:00000000 00000000     0        0 "
      "1235 2 0000000000000000 4\n"
      "  102: EF4C43EF:1DF3 00000000:0000 07 00000000:zz 00:00000000 00000000     0        0 1236 "
      "2 0000000000000000 9\n"
      "cut short\n");
  const UdpQueues queues = parse_udp_queues(table);
  EXPECT_EQ(queues.waiting_bytes, 0xB00);
  EXPECT_EQ(queues.dropped, 7);
}

}  // namespace process_load_test
}  // namespace nodmap::bench
