// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/terminal.hpp"

#include <gtest/gtest.h>

namespace nodmap::procman {
namespace terminal_test {

TEST(Keys, AreReadOneByOne) {
  std::string typed = "x\x1B[A\x1B[BsSqr";
  EXPECT_EQ(take_key(typed), Key::kUp);
  EXPECT_EQ(take_key(typed), Key::kDown);
  EXPECT_EQ(take_key(typed), Key::kStart);
  EXPECT_EQ(take_key(typed), Key::kStartGroup);
  EXPECT_EQ(take_key(typed), Key::kQuit);
  EXPECT_EQ(take_key(typed), Key::kRestart);
  EXPECT_FALSE(take_key(typed).has_value());
}

TEST(Keys, DigitsAreScriptsAndPagesScroll) {
  std::string typed = "1\x1B[5~9\x1B[6~0";
  EXPECT_EQ(take_key(typed), Key::kFirstScript);
  EXPECT_EQ(take_key(typed), Key::kPageUp);
  EXPECT_EQ(take_key(typed), Key::kLastScript);
  EXPECT_EQ(take_key(typed), Key::kPageDown);
  EXPECT_FALSE(take_key(typed).has_value());
}

// Otherwise F5 would start scripts 1 and 5. Its bytes may arrive one by one.
TEST(Keys, AFunctionKeyIsNotReadAsDigits) {
  std::string typed;
  for (const char* key : {"\x1B[15~", "\x1B[1;5A", "\x1BOS", "\x1B[3~"}) {
    for (const char* byte = key; *byte != '\0'; ++byte) {
      typed += *byte;
      EXPECT_FALSE(take_key(typed).has_value()) << key + 1;
    }
    EXPECT_TRUE(typed.empty()) << key + 1;
  }
  typed = "\x1Bq";  // Escape, then q
  EXPECT_EQ(take_key(typed), Key::kQuit);
}

}  // namespace terminal_test
}  // namespace nodmap::procman
