// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/serial/stop_event.hpp"

#include <gtest/gtest.h>

namespace nodmap::serial {
namespace {

TEST(StopEvent, StaysRaised) {
  const StopEvent stop;
  EXPECT_FALSE(stop.raised());
  stop.raise();
  EXPECT_TRUE(stop.raised());
  EXPECT_TRUE(stop.raised());
  stop.raise();
  EXPECT_TRUE(stop.raised());
}

}  // namespace
}  // namespace nodmap::serial
