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

TEST(Permissions, AreTheCommandsOfTheDeputyCharacterByCharacter) {
  const Permissions here("here", parse_config(kConfig).config);
  ASSERT_TRUE(here.resources_of("a", "prog --x"));
  EXPECT_EQ(here.resources_of("a", "prog --x")->nice, 5);
  EXPECT_FALSE(here.resources_of("a", "prog  --x"));
  EXPECT_FALSE(here.resources_of("a", "prog"));
  EXPECT_FALSE(here.resources_of("b", "other")) << "that is for another deputy";
  EXPECT_FALSE(here.is_empty());
  EXPECT_TRUE(Permissions("elsewhere", parse_config(kConfig).config).is_empty());
}

// Otherwise orders could start it a thousand times, or with the priority of another command.
TEST(Permissions, AnExecLineIsPermittedUnderItsNameOnly) {
  const char* const config = R"(
    cmd "a" { exec = "prog"; host = "here"; }
    cmd "b" { exec = "other"; host = "here"; })";
  const Permissions here("here", parse_config(config).config);
  EXPECT_TRUE(here.resources_of("a", "prog"));
  EXPECT_FALSE(here.resources_of("a2", "prog"));
  EXPECT_FALSE(here.resources_of("", "prog"));
  EXPECT_FALSE(here.resources_of("b", "prog"));
}

TEST(Permissions, AreEverythingOnlyIfThatIsAskedFor) {
  EXPECT_TRUE(Permissions::everything().resources_of("any", "rm -rf /"));
  EXPECT_FALSE(Permissions::everything().is_empty());
  EXPECT_FALSE(Permissions().resources_of("", "true"));
  EXPECT_TRUE(Permissions().is_empty());
}

}  // namespace permissions_test
}  // namespace nodmap::procman
