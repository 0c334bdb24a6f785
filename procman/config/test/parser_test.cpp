// SPDX-License-Identifier: BSD-3-Clause
#include "procman/config/parser.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "common/formats/input_file.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::procman {
namespace parser_test {

using ::testing::HasSubstr;

Config parsed(std::string_view text) {
  ParsedConfig result = parse_config(text);
  for (const ConfigError& error : result.errors) {
    ADD_FAILURE() << describe("text", error);
  }
  return result.config;
}

// The single error of a text, as FILE:LINE:COLUMN: text.
std::string error_of(std::string_view text) {
  const ParsedConfig result = parse_config(text);
  return result.errors.size() == 1 ? describe("f", result.errors[0])
                                   : std::to_string(result.errors.size()) + " errors";
}

TEST(Parser, ReadsEveryAttribute) {
  const Config config = parsed(R"(cmd "a" {
      exec = "X=1 prog --flag 'b c'"; host = "rover"; auto_respawn = "Yes"; group = "g";
      stop_signal = 15; stop_time_allowed = 3; })");
  ASSERT_EQ(config.commands.size(), 1U);
  const Command& command = config.commands[0];
  EXPECT_EQ(command.id, "a");
  EXPECT_EQ(command.exec, "X=1 prog --flag 'b c'");
  EXPECT_EQ(command.deputy, "rover");
  EXPECT_TRUE(command.auto_respawn);
  EXPECT_EQ(command.group, "g");
  EXPECT_EQ(command.stop_signal, 15);
  EXPECT_EQ(command.stop_time_allowed_s, 3);
}

TEST(Parser, HasTheDefaultsOfTheExistingTools) {
  const Command command = parsed("cmd \"a\" { exec = \"x\"; }").commands.at(0);
  EXPECT_EQ(command.deputy, "localhost");
  EXPECT_FALSE(command.auto_respawn);
  EXPECT_EQ(command.stop_signal, 2);
  EXPECT_EQ(command.stop_time_allowed_s, 7);
  EXPECT_EQ(command.group, "");
}

TEST(Parser, DeputyMeansTheSameAsHost) {
  EXPECT_EQ(parsed("cmd \"a\" { exec = \"x\"; deputy = \"d\"; }").commands.at(0).deputy, "d");
}

// A file whose command has this auto_respawn, whose value begins in column 38.
std::string respawning(const std::string& word) {
  return R"(cmd "a" { exec = "x"; auto_respawn = ")" + word + "\"; }";
}

// The existing tools take every other word for false, so that a typing error goes unnoticed until
// the command is not restarted.
TEST(Parser, OnlyTrueAndFalseSayWhetherToRespawn) {
  for (const char* word : {"true", "TRUE", "yes"}) {
    EXPECT_TRUE(parsed(respawning(word)).commands.at(0).auto_respawn) << word;
  }
  for (const char* word : {"false", "No"}) {
    EXPECT_FALSE(parsed(respawning(word)).commands.at(0).auto_respawn) << word;
  }
  for (const std::string word : {"tru", "1", "on", ""}) {
    EXPECT_EQ(error_of(respawning(word)), "f:1:38: \"" + word + "\" is neither true nor false");
  }
}

TEST(Parser, AnAttributeOrRuleIsSetOnce) {
  EXPECT_EQ(error_of("cmd \"a\" { exec = \"x\"; exec = \"y\"; }"),
            "f:1:23: exec is already set in this command");
  EXPECT_THAT(error_of("cmd \"a\" { host = \"x\"; exec = \"y\"; deputy = \"x\"; }"),
              HasSubstr("deputy is already set"))
      << "another word for host";
  EXPECT_THAT(error_of("cmd \"a\" { exec = \"x\";\n#nodmap: nice = 5; nice = 10;\n}"),
              HasSubstr("f:2:20: nice is already set"));
  EXPECT_EQ(parsed("cmd \"a\" { exec = \"x\"; } cmd \"b\" { exec = \"y\"; }").commands.size(), 2U);
}

TEST(Parser, NumbersCommandsWithoutAName) {
  const Config config = parsed("cmd { exec = \"x\"; } cmd { exec = \"y\"; }");
  EXPECT_EQ(config.commands[0].id, "unnamed-1");
  EXPECT_EQ(config.commands[1].id, "unnamed-2");
}

TEST(Parser, NestsAndMergesGroups) {
  const Config config = parsed(R"(
      group "a" { group "b" { cmd "x" { exec = "x"; group = "elsewhere"; } } }
      group "a" { cmd "y" { exec = "y"; } })");
  EXPECT_EQ(config.commands[0].group, "a/b") << "the enclosing group replaces the attribute";
  EXPECT_EQ(config.commands[1].group, "a");
  EXPECT_TRUE(config.has_group("a"));
  EXPECT_TRUE(config.has_group("/a/b/"));
  EXPECT_EQ(std::ranges::count(config.groups, "a"), 1);
}

TEST(Parser, ReadsEveryAction) {
  const Config config = parsed(R"(
      group "g" { cmd "a" { exec = "x"; } }
      script "other" { }
      script "s" {
        start everything;
        start cmd "a" wait "running";
        stop group "g" wait "stopped";
        restart cmd "a";
        wait ms 1500;
        wait cmd "a" status "running";
        wait group "g" status "stopped";
        run_script "other";
      })");
  const std::vector<Action>& actions = config.find_script("s")->actions;
  ASSERT_EQ(actions.size(), 8U);
  const auto& everything = std::get<Order>(actions[0].what);
  EXPECT_EQ(everything.verb, Verb::kStart);
  EXPECT_EQ(everything.target.kind, TargetKind::kEverything);
  EXPECT_FALSE(everything.wait.has_value());
  const auto& start = std::get<Order>(actions[1].what);
  EXPECT_EQ(start.target.kind, TargetKind::kCommand);
  EXPECT_EQ(start.target.name, "a");
  EXPECT_EQ(start.wait, Wanted::kRunning);
  const auto& stop = std::get<Order>(actions[2].what);
  EXPECT_EQ(stop.verb, Verb::kStop);
  EXPECT_EQ(stop.target.kind, TargetKind::kGroup);
  EXPECT_EQ(stop.wait, Wanted::kStopped);
  EXPECT_EQ(std::get<Order>(actions[3].what).verb, Verb::kRestart);
  EXPECT_EQ(std::get<Pause>(actions[4].what).duration_ms, 1500);
  EXPECT_EQ(std::get<WaitFor>(actions[5].what).status, Wanted::kRunning);
  EXPECT_EQ(std::get<WaitFor>(actions[6].what).target.kind, TargetKind::kGroup);
  EXPECT_EQ(std::get<RunScript>(actions[7].what).name, "other");
  EXPECT_EQ(actions[4].place.line, 9);
}

TEST(Parser, ReadsEveryVerbTargetAndWait) {
  const std::string head =
      "group \"g\" { group \"h\" { cmd \"a\" { exec = \"x\"; } } } script \"s\" { ";
  const std::vector<std::pair<std::string, Verb>> verbs{
      {"start", Verb::kStart}, {"stop", Verb::kStop}, {"restart", Verb::kRestart}};
  const std::vector<std::pair<std::string, TargetKind>> targets{
      {"everything", TargetKind::kEverything},
      {"cmd \"a\"", TargetKind::kCommand},
      {"group \"g/h\"", TargetKind::kGroup}};
  const std::vector<std::pair<std::string, std::optional<Wanted>>> waits{
      {"", std::nullopt},
      {" wait \"running\"", Wanted::kRunning},
      {" wait \"stopped\"", Wanted::kStopped}};
  for (const auto& [verb_text, verb] : verbs) {
    for (const auto& [target_text, target] : targets) {
      for (const auto& [wait_text, wait] : waits) {
        const std::string text = head + verb_text + " " + target_text + wait_text + "; }";
        const auto order = std::get<Order>(parsed(text).scripts.at(0).actions.at(0).what);
        EXPECT_EQ(order.verb, verb) << text;
        EXPECT_EQ(order.target.kind, target) << text;
        EXPECT_EQ(order.wait, wait) << text;
      }
    }
  }
  for (std::size_t target = 1; target < targets.size(); ++target) {
    for (const Wanted wanted : {Wanted::kRunning, Wanted::kStopped}) {
      const std::string word = wanted == Wanted::kRunning ? "running" : "stopped";
      const std::string text =
          head + "wait " + targets[target].first + " status \"" + word + "\"; }";
      const auto wait = std::get<WaitFor>(parsed(text).scripts.at(0).actions.at(0).what);
      EXPECT_EQ(wait.target.kind, targets[target].second) << text;
      EXPECT_EQ(wait.status, wanted) << text;
    }
  }
}

TEST(Parser, ReadsHealthRulesFromComments) {
  const Config config = parsed(R"(cmd "a" {
      exec = "x";
      #nodmap: status_name = "nodmap-x"; restart_silent_s = 5;
      #nodmap: restart_failed_s = 10; restart_mute_s = 20;  # why
      host = "h";
    })");
  const HealthRule& rule = config.commands.at(0).health;
  EXPECT_EQ(rule.status_name, "nodmap-x");
  EXPECT_EQ(rule.restart_silent_s, 5);
  EXPECT_EQ(rule.restart_failed_s, 10);
  EXPECT_EQ(rule.restart_mute_s, 20);
  EXPECT_EQ(config.commands[0].deputy, "h");
}

// A tool that skips these comments must read the same commands.
TEST(Parser, OurCommentsMayContainOnlyCompleteRules) {
  for (const char* rule : {"host = \"h\";", "}", "restart_silent_s =", "restart_silent_s = 5", "{",
                           "restart_soon_s = 5;", "restart_silent_s = 0;"}) {
    const std::string text = std::string("cmd \"a\" { exec = \"x\";\n#nodmap: ") + rule + "\n; }";
    EXPECT_FALSE(parse_config(text).errors.empty()) << rule;
  }
  EXPECT_FALSE(parse_config("cmd \"a\" { exec = \"x\"; restart_silent_s = 5; }").errors.empty());
  EXPECT_FALSE(parse_config("#nodmap: cmd \"a\" { exec = \"x\"; }").errors.empty());
}

TEST(Parser, AnErrorNamesItsPlaceAndCause) {
  EXPECT_EQ(error_of("cmd \"a\" {\n  exe = \"x\";\n}"), "f:2:3: unrecognized attribute exe");
  EXPECT_EQ(error_of("cmd \"a\" { }"), "f:1:11: the command \"a\" has no exec");
  EXPECT_EQ(error_of("cmd \"a/b\" { exec = \"x\"; }"),
            "f:1:5: a command's name must not contain '/'");
  EXPECT_THAT(error_of("group \" \" { }"), HasSubstr("f:1:7: a group's name"));
  EXPECT_THAT(error_of("group \"a/b\" { }"), HasSubstr("f:1:7: a group's name"));
  EXPECT_EQ(error_of("cmd \"a\" { exec = 5; }"), "f:1:18: expected a text in quotes, found '5'");
  EXPECT_EQ(error_of("cmd \"a\" { exec = \"x\"; stop_signal = 0; }"),
            "f:1:37: 0 is not within 1 to 64");
  EXPECT_EQ(error_of("cmd \"a\" { exec = \"x\"; stop_time_allowed = 0; }"),
            "f:1:43: 0 is not within 1 to 86400");
  EXPECT_THAT(error_of("cmd \"a\" { exec = \"x\"; stop_time_allowed = 99999999999999999999; }"),
              HasSubstr("is not within"));
  EXPECT_EQ(error_of("cmd \"a\" { exec = \"x\"; }\ncmd \"a\" { exec = \"x\"; }"),
            "f:2:5: there is a command \"a\" in line 1 already");
  EXPECT_EQ(error_of("cmd \"a\" { exec = \"x\""),
            "f:1:21: expected ';', found the end of the file");
  EXPECT_THAT(error_of("host"), HasSubstr("f:1:1: expected cmd, group, script, found 'host'"));
}

TEST(Parser, UnknownNamesInScriptsAreErrors) {
  const auto result = parse_config(R"(script "s" {
      start cmd "none";
      wait group "none" status "running";
      run_script "none";
      start cmd "none" wait "running";
    })");
  ASSERT_EQ(result.errors.size(), 4U);
  EXPECT_EQ(describe("f", result.errors[0]), "f:2:7: there is no command \"none\"");
  EXPECT_EQ(describe("f", result.errors[1]), "f:3:7: there is no group \"none\"");
  EXPECT_EQ(describe("f", result.errors[2]), "f:4:7: there is no script \"none\"");
  EXPECT_EQ(result.errors[3].place.line, 5);
}

TEST(Parser, RefusesScriptsThatRunThemselves) {
  EXPECT_THAT(error_of("script \"s\" { run_script \"s\"; }"), HasSubstr("runs itself"));
  const auto result = parse_config(R"(
      script "a" { run_script "b"; } script "b" { run_script "c"; } script "c" { run_script "a"; }
      script "d" { run_script "a"; })");
  EXPECT_EQ(result.errors.size(), 3U) << "all scripts of the circle, but not d, which calls it";
}

TEST(Parser, RefusesInvalidSyntax) {
  for (const char* text :
       {"script \"s\" { start; }", "script \"s\" { launch everything; }",
        "script \"s\" { start everything wait \"done\"; }", "script \"s\" { wait ms \"5\"; }",
        "script \"s\" { start everything wait running; }", "script s { }", "group g { }",
        "group \"g\" { script \"s\" { } }", "script \"s\" { } script \"s\" { }", "}", "cmd cmd",
        "script \"s\" { start everything }"}) {
    EXPECT_EQ(parse_config(text).errors.size(), 1U) << text;
  }
}

TEST(Parser, GroupsNestedTooDeeplyAreAnError) {
  std::string text;
  for (int i = 0; i < 100000; ++i) {
    text += "group \"g\" {";
  }
  EXPECT_THAT(error_of(text), HasSubstr("nested too deeply"));
}

TEST(Parser, AnEmptyFileIsAnEmptyConfiguration) {
  EXPECT_TRUE(parsed("").commands.empty());
  EXPECT_TRUE(parsed(" # nothing\n").commands.empty());
}

TEST(Parser, ReadsAFileOrNamesAllItsErrors) {
  const test::TemporaryDir dir;
  EXPECT_THROW(static_cast<void>(load_config(dir.path() / "none.pmd")), formats::InputFileError);
  const std::filesystem::path file = dir.path() / "bad.pmd";
  std::ofstream(file) << "script \"s\" { start cmd \"x\";\nstop cmd \"y\"; }";
  try {
    static_cast<void>(load_config(file));
    FAIL();
  } catch (const formats::InputFileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("bad.pmd:1:14: there is no command \"x\""));
    EXPECT_THAT(error.what(), HasSubstr("bad.pmd:2:1: there is no command \"y\""));
  }
}

TEST(Parser, ReadsResourcesAndHealthFromOurComments) {
  const ParsedConfig parsed = parse_config(R"(
    cmd "a" { exec = "x";
      #nodmap: nice = 10; realtime = 20; restart_degraded_s = 30;
      #nodmap: memory_mb = 500; cpus = "0,2-3";
    }
    script "s" { start cmd "a";
      #nodmap: wait cmd "a" status "healthy";
      wait ms 5;
    })");
  ASSERT_TRUE(parsed.errors.empty()) << parsed.errors.front().text;
  EXPECT_EQ(parsed.config.commands[0].resources.nice, 10);
  EXPECT_EQ(parsed.config.commands[0].resources.realtime, 20);
  EXPECT_EQ(parsed.config.commands[0].health.restart_degraded_s, 30);
  EXPECT_EQ(parsed.config.commands[0].resources.memory_mb, 500);
  EXPECT_EQ(parsed.config.commands[0].resources.cpus, (std::vector<int>{0, 2, 3}));
  const auto& actions = parsed.config.find_script("s")->actions;
  ASSERT_EQ(actions.size(), 3U);
  EXPECT_EQ(std::get<WaitFor>(actions[1].what).status, Wanted::kHealthy);
  EXPECT_EQ(std::get<WaitFor>(actions[1].what).target.name, "a");
}

TEST(Parser, RefusesAnInvalidListOfProcessors) {
  for (const char* cpus : {"", "a", "1,", "3-1", "-1", "1024", "0-", "0 1"}) {
    const ParsedConfig parsed = parse_config(
        std::string("cmd \"a\" { exec = \"x\";\n#nodmap: cpus = \"") + cpus + "\";\n}");
    ASSERT_EQ(parsed.errors.size(), 1U) << cpus;
    EXPECT_EQ(parsed.errors[0].place.line, 2) << cpus;
  }
}

// The existing tools could not read these outside a comment.
TEST(Parser, OurExtensionsAreAllowedInCommentsOnly) {
  const std::string head = "cmd \"a\" { exec = \"x\"; } script \"s\" { ";
  EXPECT_FALSE(parse_config(head + "wait cmd \"a\" status \"healthy\"; }").errors.empty());
  EXPECT_FALSE(parse_config(head + "\n#nodmap: stop cmd \"a\";\n }").errors.empty());
  EXPECT_FALSE(
      parse_config(head + "\n#nodmap: wait cmd \"b\" status \"healthy\";\n }").errors.empty());
  EXPECT_FALSE(parse_config("cmd \"a\" { exec = \"x\"; nice = 5; }").errors.empty());
}

}  // namespace parser_test
}  // namespace nodmap::procman
