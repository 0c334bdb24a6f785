// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/serial/back_off.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace nodmap::serial {
namespace {

TEST(BackOff, DoublesFromATenthOfASecondToFiveSeconds) {
  BackOff back_off;
  std::int64_t now_us = 0;
  EXPECT_TRUE(back_off.due(now_us));
  std::vector<std::int64_t> waits;
  for (int i = 0; i < 8; ++i) {
    back_off.failed(now_us);
    EXPECT_FALSE(back_off.due(now_us));
    waits.push_back(back_off.wait_us(now_us));
    now_us += waits.back();
    EXPECT_TRUE(back_off.due(now_us));
    EXPECT_EQ(back_off.wait_us(now_us), 0);
  }
  EXPECT_EQ(waits, (std::vector<std::int64_t>{100'000, 200'000, 400'000, 800'000, 1'600'000,
                                              3'200'000, 5'000'000, 5'000'000}));
}

TEST(BackOff, SuccessStartsOver) {
  BackOff back_off;
  back_off.failed(0);
  back_off.failed(100'000);
  back_off.succeeded();
  EXPECT_TRUE(back_off.due(0));
  back_off.failed(1'000'000);
  EXPECT_EQ(back_off.wait_us(1'000'000), BackOff::kFirstUs);
}

}  // namespace
}  // namespace nodmap::serial
