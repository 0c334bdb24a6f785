// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/patience.hpp"

#include <gtest/gtest.h>

namespace nodmap::navigator {
namespace patience_test {

constexpr time::Timestamp kStart{100s};

// Decides ten times a second until `stamp`.
void decide_until(Patience& patience, time::Timestamp from, time::Timestamp until) {
  for (time::Timestamp stamp = from; stamp <= until; stamp += 100ms) {
    patience.record(stamp);
  }
}

TEST(Patience, IsOverAfterItsTimeWithoutProgress) {
  Patience patience(3s);
  EXPECT_FALSE(patience.is_over(kStart));
  patience.restart(kStart);
  decide_until(patience, kStart, kStart + 3s);
  EXPECT_FALSE(patience.is_over(kStart + 2999ms));
  EXPECT_TRUE(patience.is_over(kStart + 3s));
  patience.restart(kStart + 3s);
  EXPECT_FALSE(patience.is_over(kStart + 3s));
}

TEST(Patience, APauseDoesNotCount) {
  Patience patience(3s);
  patience.restart(kStart);
  decide_until(patience, kStart, kStart + 2s);
  patience.record(kStart + 2201ms);
  EXPECT_FALSE(patience.has_begun());
  EXPECT_FALSE(patience.is_over(kStart + 10s));
}

}  // namespace patience_test
}  // namespace nodmap::navigator
