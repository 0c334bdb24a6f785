// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/request.hpp"

#include <gtest/gtest.h>

#include "nodmap/status_t.hpp"

namespace nodmap::node {
namespace request_test {

TEST(HandleUntil, HandlesWhatHasArrivedAlsoWithoutTimeToWait) {
  bus::LiveBus bus("memq://");
  int received = 0;
  bus.subscribe<nodmap::status_t>("STATUS", [&](const nodmap::status_t&) { ++received; });
  bus.publish("STATUS", nodmap::status_t{});
  EXPECT_TRUE(handle_until(bus, 0.0, [&] { return received == 1; }));
  EXPECT_FALSE(handle_until(bus, 0.0, [&] { return received == 2; }));
}

}  // namespace request_test
}  // namespace nodmap::node
