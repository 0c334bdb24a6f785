// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/output_follower.hpp"

#include <gtest/gtest.h>

namespace nodmap::procman {
namespace output_follower_test {

TEST(OutputFollower, PrintsTheLastOutputAndThenWhatFollows) {
  OutputFollower follower(true);
  EXPECT_EQ(follower.take("2\n"), "") << "the last output contains it";
  EXPECT_EQ(follower.take_last("1\n2\n"), "1\n2\n");
  EXPECT_EQ(follower.take("3\n"), "3\n");
  EXPECT_EQ(follower.take_last("1\n2\n3\n"), "") << "repeated for another sheriff";
  EXPECT_EQ(follower.stop_waiting(), "");
  EXPECT_EQ(follower.take("4\n"), "4\n");
}

TEST(OutputFollower, WithoutALastOutputItPrintsWhatHasCome) {
  OutputFollower follower(true);
  EXPECT_EQ(follower.take("1\n"), "");
  EXPECT_EQ(follower.take("2\n"), "");
  EXPECT_EQ(follower.stop_waiting(), "1\n2\n");
  EXPECT_EQ(follower.take_last("1\n2\n"), "");
  EXPECT_EQ(follower.take("3\n"), "3\n");
}

// A file and a pipe get no colours, wherever the pieces end.
TEST(OutputFollower, LeavesOutColoursUnlessTheyAreWanted) {
  const std::string coloured = "\x1B[1;32minfo\x1B[0m: on\n";
  OutputFollower terminal(true);
  EXPECT_EQ(terminal.take_last(coloured), coloured);
  OutputFollower file(false);
  std::string printed = file.take_last(coloured);
  for (const char c : coloured) {
    printed += file.take(std::string(1, c));
  }
  EXPECT_EQ(printed, "info: on\ninfo: on\n");
}

}  // namespace output_follower_test
}  // namespace nodmap::procman
