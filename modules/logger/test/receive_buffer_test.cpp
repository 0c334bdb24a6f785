// SPDX-License-Identifier: BSD-3-Clause
#include "modules/logger/receive_buffer.hpp"

#include <gtest/gtest.h>

namespace nodmap::logger {
namespace receive_buffer_test {

TEST(ReceiveBuffer, IsRequestedForUdpmOnly) {
  EXPECT_EQ(with_receive_buffer("udpm://239.255.76.67:7667?ttl=0", 4096),
            "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4096");
  EXPECT_EQ(with_receive_buffer("udpm://239.255.76.67:7667", 4096),
            "udpm://239.255.76.67:7667?recv_buf_size=4096");
  EXPECT_EQ(with_receive_buffer("memq://", 4096), "memq://");
}

TEST(ReceiveBuffer, ASizeInTheUrlIsKept) {
  const std::string url = "udpm://239.255.76.67:7667?recv_buf_size=99&ttl=0";
  EXPECT_EQ(with_receive_buffer(url, 4096), url);
  EXPECT_EQ(with_receive_buffer("udpm://239.255.76.67:7667", 0), "udpm://239.255.76.67:7667");
}

}  // namespace receive_buffer_test
}  // namespace nodmap::logger
