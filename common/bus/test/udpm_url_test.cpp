// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/udpm_url.hpp"

#include <gtest/gtest.h>

namespace nodmap::bus {
namespace udpm_url_test {

TEST(UdpmUrl, ReadsAllParts) {
  const auto url = parse_udpm_url("udpm://239.1.2.3:7700?recv_buf_size=100&ttl=1");
  ASSERT_TRUE(url.has_value());
  EXPECT_EQ(url->group_text(), "239.1.2.3");
  EXPECT_EQ(url->port, 7700);
  EXPECT_EQ(url->ttl, 1);
  EXPECT_EQ(url->receive_buffer_bytes, 100);
}

TEST(UdpmUrl, MissingPartsGetLcmsDefaults) {
  for (const char* text : {"udpm://", "udpm://239.255.76.67", "udpm://239.255.76.67:7667",
                           "udpm://:7667", "udpm://239.255.76.67:7667?ttl=0",
                           "udpm://239.255.76.67:7667?", "udpm://?ttl=0&&ttl=0,ttl=0&"}) {
    const auto url = parse_udpm_url(text);
    ASSERT_TRUE(url.has_value()) << text;
    EXPECT_EQ(url->group_text(), "239.255.76.67");
    EXPECT_EQ(url->port, 7667);
    EXPECT_EQ(url->ttl, 0);
    EXPECT_EQ(url->receive_buffer_bytes, 4 << 20);
  }
}

TEST(UdpmUrl, OtherUrlsAreRefused) {
  for (const char* text :
       {"", "memq://", "file:///tmp/log", "udpm://300.0.0.1:7667", "udpm://239.255.76.67:70000",
        "udpm://somewhere:7667", "udpm://239.255.76.67:99999999999999",
        "udpm://239.255.76.67:7667?tttl=1", "udpm://239.255.76.67:7667?ttl=abc",
        "udpm://239.255.76.67:7667?ttl", "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4M"}) {
    EXPECT_FALSE(parse_udpm_url(text)) << text;
  }
}

}  // namespace udpm_url_test
}  // namespace nodmap::bus
