// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/permissions.hpp"

#include <gtest/gtest.h>

#include "procman/config/parser.hpp"

namespace nodmap::procman {
namespace permissions_test {

const char* const kConfig = R"(
    cmd "a" { exec = "prog --x"; host = "here"; #nodmap: nice = 5;
    }
    cmd "b" { exec = "other"; host = "there"; })";

TEST(Permissions, AreTheExecLinesOfTheDeputyCharacterByCharacter) {
  const Permissions here("here", parse_config(kConfig).config);
  EXPECT_TRUE(here.may_run("prog --x"));
  EXPECT_FALSE(here.may_run("prog  --x"));
  EXPECT_FALSE(here.may_run("prog"));
  EXPECT_FALSE(here.may_run("other")) << "that is for another deputy";
  EXPECT_EQ(here.resources_of("a").nice, 5);
  EXPECT_EQ(here.resources_of("unknown").nice, 0);
  EXPECT_FALSE(here.is_empty());
  EXPECT_TRUE(Permissions("elsewhere", parse_config(kConfig).config).is_empty());
}

TEST(Permissions, AreEverythingOnlyIfThatIsAskedFor) {
  EXPECT_TRUE(Permissions::everything().may_run("rm -rf /"));
  EXPECT_FALSE(Permissions::everything().is_empty());
  EXPECT_FALSE(Permissions().may_run("true"));
  EXPECT_TRUE(Permissions().is_empty());
}

}  // namespace permissions_test
}  // namespace nodmap::procman
