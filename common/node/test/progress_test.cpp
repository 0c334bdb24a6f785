// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/progress.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nodmap::node {
namespace progress_test {

using ::testing::EndsWith;
using ::testing::HasSubstr;

TEST(Progress, EstimatesTheRemainingTimeFromThePaceSoFar) {
  EXPECT_THAT(progress_line("a.log", 0.25, 10.0), EndsWith(" 25 %, about 30 s left"));
  EXPECT_THAT(progress_line("a.log", 0.1, 60.0), EndsWith(" 10 %, about 9 min left"));
  EXPECT_THAT(progress_line("a.log", 1.0, 60.0), EndsWith("100 %, about 0 s left"));
}

TEST(Progress, GivesNoEstimateBeforeThePaceIsKnown) {
  EXPECT_THAT(progress_line("a.log", 0.0, 60.0), EndsWith("  0 %"));
  EXPECT_THAT(progress_line("a.log", 0.5, 0.1), EndsWith(" 50 %"));
}

TEST(Progress, TheBarHasFortyCharactersForAnyFraction) {
  EXPECT_THAT(progress_line("a", 0.5, 0.0),
              HasSubstr("[" + std::string(20, '#') + std::string(20, ' ') + "]"));
  EXPECT_THAT(progress_line("a", 7.0, 0.0), HasSubstr("[" + std::string(40, '#') + "]"));
  EXPECT_THAT(progress_line("a", -1.0, 0.0), HasSubstr("[" + std::string(40, ' ') + "]"));
  EXPECT_THAT(progress_line(std::string(300, 'x'), 0.0, 0.0), EndsWith("  0 %"));
}

}  // namespace progress_test
}  // namespace nodmap::node
