// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "procman/deputy/child_process.hpp"

namespace nodmap::procman {
namespace exec_line_test {

using ::testing::ElementsAre;
using ::testing::Pair;

ExecLine parsed(std::string_view line) {
  return parse_exec_line(line, [](const std::string& name) -> std::optional<std::string> {
    return name == "HOME" ? std::optional<std::string>("/home/me") : std::nullopt;
  });
}

TEST(ExecLine, SplitsAtBlanksThatAreNotQuoted) {
  EXPECT_THAT(parsed("  prog  a 'b c' \"d 'e'\" f\\ g x'y z'w ").arguments,
              ElementsAre("prog", "a", "b c", "d 'e'", "f g", "xy zw"));
  EXPECT_THAT(parsed("prog '' \"\"").arguments, ElementsAre("prog", "", ""));
}

TEST(ExecLine, TakesLeadingAssignmentsOnly) {
  const ExecLine exec = parsed("A=1 B='2 3' E= prog C=4");
  EXPECT_THAT(exec.environment, ElementsAre(Pair("A", "1"), Pair("B", "2 3"), Pair("E", "")));
  EXPECT_THAT(exec.arguments, ElementsAre("prog", "C=4"));
}

TEST(ExecLine, ReplacesVariablesThatAreSet) {
  EXPECT_THAT(
      parsed("prog $HOME/x ${HOME}y $NONE ${NONE} $ ${HOME $1").arguments,
      ElementsAre("prog", "/home/me/x", "/home/mey", "$NONE", "${NONE}", "$", "${HOME", "$1"));
}

// Both existing deputies crash on these lines.
TEST(ExecLine, ALineWithoutAProgramGivesNoArguments) {
  for (const char* line : {"", "   ", "A=1", "A= ", "A=1 B=2"}) {
    EXPECT_TRUE(parsed(line).arguments.empty()) << line;
  }
  EXPECT_THAT(parsed("=x").arguments, ElementsAre("=x"));
}

TEST(ExecLine, AnOpenQuoteExtendsToTheEnd) {
  EXPECT_THAT(parsed("prog 'a b").arguments, ElementsAre("prog", "a b"));
  EXPECT_THAT(parsed("prog a\\").arguments, ElementsAre("prog", "a\\"));
}

}  // namespace exec_line_test
}  // namespace nodmap::procman
