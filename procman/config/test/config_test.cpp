// SPDX-License-Identifier: BSD-3-Clause
#include "procman/config/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "procman/config/exec_line.hpp"
#include "procman/config/parser.hpp"
#include "tests/support/program.hpp"

namespace nodmap::procman {
namespace config_test {

std::vector<std::string> ids(const std::vector<const Command*>& commands) {
  std::vector<std::string> all;
  for (const Command* command : commands) {
    all.push_back(command->id);
  }
  return all;
}

TEST(Config, AGroupIncludesItsSubgroupsButNotGroupsOfTheSameNameElsewhere) {
  const auto parsed = parse_config(R"(
      cmd "top" { exec = "t"; }
      group "a" { cmd "x" { exec = "x"; } group "b" { cmd "y" { exec = "y"; } } }
      group "ab" { cmd "z" { exec = "z"; } })");
  ASSERT_TRUE(parsed.errors.empty());
  const Config& config = parsed.config;
  using ::testing::ElementsAre;
  EXPECT_THAT(ids(config.commands_of({TargetKind::kGroup, "a"})), ElementsAre("x", "y"));
  EXPECT_THAT(ids(config.commands_of({TargetKind::kGroup, "/a//b/"})), ElementsAre("y"));
  EXPECT_THAT(ids(config.commands_of({TargetKind::kCommand, "top"})), ElementsAre("top"));
  EXPECT_THAT(ids(config.commands_of({})), ElementsAre("top", "x", "y", "z"));
  EXPECT_TRUE(config.commands_of({TargetKind::kGroup, "c"}).empty());
}

TEST(Config, NormalizesGroupPaths) {
  EXPECT_EQ(normalized_group("//a///b/"), "a/b");
  EXPECT_EQ(normalized_group("/"), "");
  EXPECT_EQ(normalized_group(""), "");
}

// A configuration's groups and scripts, without its introduction.
std::string groups_and_scripts(const std::string& name) {
  const std::string text = test::slurp(std::string(NODMAP_PMD_DIR) + "/" + name);
  return text.substr(text.find("\ngroup "));
}

TEST(TwoHosts, IsTheRobotExceptForTheHosts) {
  std::string two_hosts = groups_and_scripts("two_hosts.pmd");
  const std::string elsewhere = "deputy = \"mapper\"";
  int moved = 0;
  for (std::size_t at = 0; (at = two_hosts.find(elsewhere)) != std::string::npos; ++moved) {
    two_hosts.replace(at, elsewhere.size(), "deputy = \"robot\"");
  }
  EXPECT_EQ(moved, 2);
  EXPECT_EQ(two_hosts, groups_and_scripts("robot.pmd"));
}

TEST(ProgramOf, IsTheFirstWordThatIsNotAnAssignment) {
  EXPECT_EQ(program_of("nodmap-slam2d"), "nodmap-slam2d");
  EXPECT_EQ(program_of("A=1 B=2 bin/nodmap-sim --x"), "nodmap-sim");
  EXPECT_EQ(program_of(""), "");
  EXPECT_EQ(program_of("NOTE='a b' nodmap-logger --out x"), "nodmap-logger");
  EXPECT_EQ(program_of("A='x y' '/opt/my robot/nodmap-kurt' -v"), "nodmap-kurt");
  EXPECT_EQ(program_of("/opt/my\\ robot/nodmap-kurt"), "nodmap-kurt");
}

}  // namespace config_test
}  // namespace nodmap::procman
