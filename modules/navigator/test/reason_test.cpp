// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/reason.hpp"

#include <gtest/gtest.h>

#include <set>

namespace nodmap::navigator {
namespace reason_test {

TEST(Reason, EveryReasonHasItsOwnSentence) {
  std::set<std::string> texts;
  for (int why = 0; why <= static_cast<int>(Why::kDocks); ++why) {
    const std::string text = to_text(Reason(static_cast<Why>(why), "x"));
    EXPECT_TRUE(texts.insert(text).second) << text;
    EXPECT_EQ(text.find('%'), std::string::npos) << text;
    EXPECT_TRUE(text.empty() == (why == 0) && (text.empty() || text.back() == '.')) << text;
  }
}

TEST(Reason, TheSentenceNamesTheCause) {
  EXPECT_EQ(to_text({Why::kStopped, "a 100% sure test"}), "Stopped by a 100% sure test.");
  EXPECT_EQ(to_text({Why::kTwoSenders, "SCAN"}), "Two processes send SCAN.");
  EXPECT_EQ(to_text(Why::kNothingToAdd), "");
}

}  // namespace reason_test
}  // namespace nodmap::navigator
