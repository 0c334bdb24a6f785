// SPDX-License-Identifier: BSD-3-Clause
#include "procman/protocol/console.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nodmap::procman {
namespace console_test {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Console, JoinsPiecesOfLines) {
  const std::string text = "one\r\ntwo\r\n\r\nthree";
  Console whole;
  whole.take(text);
  Console pieces;
  for (const char c : text) {
    pieces.take(std::string(1, c));
  }
  EXPECT_THAT(whole.lines(), ElementsAre("one", "two", "", "three"));
  EXPECT_EQ(pieces.lines(), whole.lines());
  pieces.take(" and more\n");
  EXPECT_EQ(pieces.last(), "three and more");
}

TEST(Console, LastIsTheNewestLineThatIsNotBlank) {
  Console console;
  EXPECT_EQ(console.last(), "");
  console.take("said\n\n  \n");
  EXPECT_EQ(console.last(), "said");
}

TEST(Console, AProgressBarIsOneLine) {
  Console console;
  console.take("10 %\r20 %\r100 %\r\ndone\n");
  EXPECT_THAT(console.lines(), ElementsAre("100 %", "done"));
}

TEST(Console, LeavesOutColourCodes) {
  const std::string text = "a \x1B[32minfo\x1B[m: b\n\x1B[1;31mred\x1B[0m\x1B(\x1B[3\nnext";
  Console console;
  for (const char c : text) {
    console.take(std::string(1, c));
  }
  EXPECT_THAT(console.lines(), ElementsAre("a info: b", "red", "next"));
}

TEST(Console, LimitsTheNumberOfLinesAndTheirLength) {
  Console console;
  EXPECT_THAT(console.lines(), IsEmpty());
  console.take(std::string(10 * Console::kMaxLineBytes, 'x'));
  EXPECT_EQ(console.last().size(), Console::kMaxLineBytes);
  for (std::size_t i = 0; i < 2 * Console::kMaxLines; ++i) {
    console.take("\n");
    console.take(std::to_string(i));
  }
  EXPECT_EQ(console.lines().size(), Console::kMaxLines);
  EXPECT_EQ(console.last(), std::to_string(2 * Console::kMaxLines - 1));
}

}  // namespace console_test
}  // namespace nodmap::procman
