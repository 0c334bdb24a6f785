// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/self_test.hpp"

#include <gtest/gtest.h>

#include "common/geometry/time.hpp"

namespace nodmap::doctor {
namespace self_test_test {

constexpr std::chrono::milliseconds kDuration = 200ms;

TEST(SelfTest, ReceivesItsMessageWithoutANetwork) {
  const SelfTest test = run_self_test("memq://", kDuration);
  EXPECT_TRUE(test.opened);
  EXPECT_TRUE(test.latency_ms.has_value());
  EXPECT_TRUE(test.received.empty());
}

TEST(SelfTest, AnUnknownProviderIsNotOpened) {
  EXPECT_FALSE(run_self_test("nonsense://x", kDuration).opened);
}

}  // namespace self_test_test
}  // namespace nodmap::doctor
