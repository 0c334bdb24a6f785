// SPDX-License-Identifier: BSD-3-Clause
#include "procman/config/lexer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace nodmap::procman {
namespace lexer_test {

std::vector<Token> tokens(std::string_view text) {
  Lexer lexer(text);
  std::vector<Token> all;
  do {
    all.push_back(lexer.next());
  } while (all.back().kind != TokenKind::kEnd);
  return all;
}

TEST(Lexer, KnowsEveryKindOfToken) {
  const auto all = tokens("cmd \"a b\" { _x-1 = 42; }");
  const std::vector<TokenKind> kinds{
      TokenKind::kIdentifier, TokenKind::kString, TokenKind::kOpen,
      TokenKind::kIdentifier, TokenKind::kAssign, TokenKind::kInteger,
      TokenKind::kSemicolon,  TokenKind::kClose,  TokenKind::kEnd};
  ASSERT_EQ(all.size(), kinds.size());
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    EXPECT_EQ(all[i].kind, kinds[i]) << i;
  }
  EXPECT_EQ(all[1].text, "a b");
  EXPECT_EQ(all[3].text, "_x-1");
  EXPECT_EQ(all[5].text, "42");
}

TEST(Lexer, CountsLinesAndColumnsFromOne) {
  const auto all = tokens("a\n  b\r\n\tc");
  EXPECT_EQ(all[0].place.line, 1);
  EXPECT_EQ(all[0].place.column, 1);
  EXPECT_EQ(all[1].place.line, 2);
  EXPECT_EQ(all[1].place.column, 3);
  EXPECT_EQ(all[2].place.line, 3);
  EXPECT_EQ(all[2].place.column, 2);
}

TEST(Lexer, UnescapesStrings) {
  EXPECT_EQ(tokens(R"("a\n\r\t\\\"\q")")[0].text, "a\n\r\t\\\"q");
}

TEST(Lexer, SkipsComments) {
  const auto all = tokens("# cmd\na # b\n#c");
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].text, "a");
}

TEST(Lexer, ReadsOurCommentsUpToTheEndOfTheirLine) {
  const auto all = tokens("a #nodmap: b = 1; # not this\nc #!nodmap: d");
  ASSERT_EQ(all.size(), 7U);
  EXPECT_FALSE(all[0].is_extension);
  for (std::size_t i = 1; i <= 4; ++i) {
    EXPECT_TRUE(all[i].is_extension) << i;
  }
  EXPECT_EQ(all[5].text, "c");
  EXPECT_FALSE(all[5].is_extension);
}

TEST(Lexer, NamesTheLineAndColumnThatItCannotRead) {
  for (const std::string text : {"a\n \"open", "a\n \"open\n\"", "a\n \"open\\", "a\n \"open\\\n",
                                 "a\n -", "a\n \x80", "a\n ?"}) {
    try {
      tokens(text);
      FAIL() << text;
    } catch (const SyntaxError& error) {
      EXPECT_EQ(error.place().line, 2) << text;
      EXPECT_EQ(error.place().column, 2) << text;
    }
  }
}

TEST(Lexer, RefusesAZeroByteInAString) {
  EXPECT_THROW(tokens(std::string_view("\"a\0b\"", 5)), SyntaxError);
}

}  // namespace lexer_test
}  // namespace nodmap::procman
