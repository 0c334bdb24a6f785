// SPDX-License-Identifier: BSD-3-Clause
#include "bench/live/process_load.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstddef>
#include <sstream>
#include <vector>

namespace nodmap::bench {
namespace process_load_test {

TEST(ProcessLoad, OfAMissingProcessIsNothing) {
  EXPECT_FALSE(read_load(-1));
}

TEST(ProcessLoad, OfThisProcessGrowsByTheMemoryThatItTakes) {
  const auto before = read_load(::getpid());
  const std::vector<char> block(std::size_t{64} << 20U, 'x');
  const auto after = read_load(::getpid());
  ASSERT_TRUE(before && after);
  EXPECT_EQ(block.back(), 'x');  // so that no compiler omits it
  // The kernel counts a thread's pages in batches of 64.
  EXPECT_NEAR(after->resident_mib - before->resident_mib, 64.0, 1.0);
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
