// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/refusals.hpp"

#include <gtest/gtest.h>

namespace nodmap::procman {
namespace refusals_test {

TEST(Refusals, TheLastOneIsReportedForTenSeconds) {
  node::MessageCounts counts;
  Refusals refusals(counts);
  EXPECT_EQ(refusals.health({}).state, node::HealthState::kOk);
  refusals.add({"too_old", "first"}, time::SteadyTime{1s});
  refusals.add({"other_sheriff", "second"}, time::SteadyTime{2s});
  EXPECT_EQ(refusals.health(time::SteadyTime{11'999ms}).state, node::HealthState::kDegraded);
  EXPECT_EQ(refusals.health(time::SteadyTime{11'999ms}).reason, "second");
  EXPECT_EQ(refusals.health(time::SteadyTime{12s}).state, node::HealthState::kOk);
  EXPECT_EQ(refusals.health(time::SteadyTime{12s}).reason, "");
  EXPECT_EQ(counts.rejected().at("too_old"), 1);
  EXPECT_EQ(counts.rejected().at("other_sheriff"), 1);
}

}  // namespace refusals_test
}  // namespace nodmap::procman
