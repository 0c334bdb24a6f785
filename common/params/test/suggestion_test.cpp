// SPDX-License-Identifier: BSD-3-Clause
#include "common/params/suggestion.hpp"

#include <gtest/gtest.h>

namespace nodmap::params {
namespace suggestion_test {

const std::vector<std::string> kKnown = {"info", "export", "matcher.max_iterations", "max_range_m"};

TEST(DidYouMean, EachKindOfTypingError) {
  EXPECT_EQ(did_you_mean("infoo", kKnown), "; did you mean 'info'?");    // one more
  EXPECT_EQ(did_you_mean("exprt", kKnown), "; did you mean 'export'?");  // one less
  EXPECT_EQ(did_you_mean("exbort", kKnown), "; did you mean 'export'?");
  EXPECT_EQ(did_you_mean("ifno", kKnown), "; did you mean 'info'?");  // swapped
}

TEST(DidYouMean, TheLastPartOfANestedNameIsEnough) {
  EXPECT_EQ(did_you_mean("max_iteration", kKnown), "; did you mean 'matcher.max_iterations'?");
  EXPECT_EQ(did_you_mean("macher.max_iterations", kKnown),
            "; did you mean 'matcher.max_iterations'?");
}

TEST(DidYouMean, SuggestsNothingIfNothingIsSimilar) {
  EXPECT_EQ(did_you_mean("something_else", kKnown), "");
  EXPECT_EQ(did_you_mean("", kKnown), "");
  EXPECT_EQ(did_you_mean("info", {}), "");
}

}  // namespace suggestion_test
}  // namespace nodmap::params
