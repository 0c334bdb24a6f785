// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/printable.hpp"

#include <gtest/gtest.h>

namespace nodmap::procman {
namespace printable_test {

TEST(Printable, ReplacesControlCharactersAndInvalidUtf8) {
  EXPECT_EQ(printable("a\x1B[31m\r\n\x7F"), "a?[31m???");
  EXPECT_EQ(printable("gr\xC3\xBC\xC3\x9F \xE2\x82\xAC"), "gr\xC3\xBC\xC3\x9F \xE2\x82\xAC");
  EXPECT_EQ(printable("\xC3"), "?");
  EXPECT_EQ(printable("\xFF\xC2\x9B!"), std::string(3, '?') + "!");
  // A surrogate; a slash encoded in two and in three bytes; a code beyond the last code point; the
  // last code point.
  EXPECT_EQ(printable("\xED\xA0\x80"), std::string(3, '?'));
  EXPECT_EQ(printable("\xC0\xAF\xE0\x80\xAF"), std::string(5, '?'));
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), std::string(4, '?'));
  EXPECT_EQ(printable("\xF4\x8F\xBF\xBF"), "\xF4\x8F\xBF\xBF");
}

TEST(Printable, IsMeasuredAndCutInCharacters) {
  const std::string text = "gr\xC3\xBC\xC3\x9F \xE2\x82\xAC";
  EXPECT_EQ(width_of(text), 6U);
  EXPECT_EQ(fitted(text, 3), "gr\xC3\xBC");
  EXPECT_EQ(fitted(text, 6), text);
  EXPECT_EQ(fitted(text, 0), "");
}

}  // namespace printable_test
}  // namespace nodmap::procman
