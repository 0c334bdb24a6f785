// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/terminal.hpp"

#include <gtest/gtest.h>

namespace nodmap::procman {
namespace {

TEST(Keys, AreTakenOneByOne) {
  std::string typed = "x\x1B[A\x1B[BsSqr";
  EXPECT_EQ(take_key(typed), Key::kUp);
  EXPECT_EQ(take_key(typed), Key::kDown);
  EXPECT_EQ(take_key(typed), Key::kStart);
  EXPECT_EQ(take_key(typed), Key::kStartGroup);
  EXPECT_EQ(take_key(typed), Key::kQuit);
  EXPECT_EQ(take_key(typed), Key::kRestart);
  EXPECT_FALSE(take_key(typed).has_value());
}

}  // namespace
}  // namespace nodmap::procman
