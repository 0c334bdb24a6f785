// SPDX-License-Identifier: BSD-3-Clause
// The command line that every program has in common.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/contract/odometry_log.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/data_dir.hpp"
#include "tests/support/program.hpp"

namespace nodmap {
namespace programs_test {

using test::run_program;
using test::write_odometry_log;
using ::testing::HasSubstr;
using ::testing::Not;

// clang-format off
// All programs that are installed.
constexpr const char* kPrograms[] = {
    "nodmap-clear",
    "nodmap-convert",
    "nodmap-deputy",
    "nodmap-doctor",
    "nodmap-evaluate",
    "nodmap-explore",
    "nodmap-explorer",
    "nodmap-goal",
    "nodmap-kurt",
    "nodmap-laser3d",
    "nodmap-latency",
    "nodmap-logger",
    "nodmap-map-server",
    "nodmap-navigator",
    "nodmap-pitch-controller",
    "nodmap-save",
    "nodmap-sheriff",
    "nodmap-sim",
    "nodmap-slam2d",
    "nodmap-slam6d",
    "nodmap-stop",
    "nodmap-trial",
    "nodmap-viewer",
    "nodmap-watch",
};
// Those of them that run on the robot and have parameters.
constexpr const char* kProcesses[] = {
    "nodmap-explorer",
    "nodmap-kurt",
    "nodmap-laser3d",
    "nodmap-logger",
    "nodmap-map-server",
    "nodmap-navigator",
    "nodmap-pitch-controller",
    "nodmap-sim",
    "nodmap-slam2d",
    "nodmap-slam6d",
    "nodmap-viewer",
};
// Those of them that also work on a recording.
constexpr const char* kModules[] = {
    "nodmap-explorer",
    "nodmap-map-server",
    "nodmap-navigator",
    "nodmap-pitch-controller",
    "nodmap-slam2d",
    "nodmap-slam6d",
};
// clang-format on

class EveryProgram : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryProgram, DescribesItselfAndItsVersion) {
  const auto help = run_program(GetParam(), {"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("--help"));
  const auto version = run_program(GetParam(), {"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out, HasSubstr("."));
}

TEST_P(EveryProgram, RefusesAnUnknownOptionInOneLine) {
  const auto result = run_program(GetParam(), {"--no-such-option"});
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

// Programs with parameters have --config and --set. All others do not use --config for files of
// another kind.
TEST_P(EveryProgram, HasConfigAndSetOnlyIfItHasParameters) {
  const bool has_parameters = std::ranges::count(kProcesses, std::string_view(GetParam())) > 0;
  const std::string help = run_program(GetParam(), {"--help"}).out;
  // The parameters of the closed loop are those of the processes in it.
  EXPECT_EQ(help.find("--set TEXT") != std::string::npos,
            has_parameters || std::string_view(GetParam()) == "nodmap-trial");
  EXPECT_EQ(help.find("--config TEXT ...           YAML file with parameters") != std::string::npos,
            has_parameters);
  // The deputy's is its process configuration.
  EXPECT_EQ(help.find("--config TEXT") != std::string::npos,
            has_parameters || std::string_view(GetParam()) == "nodmap-deputy");
}

INSTANTIATE_TEST_SUITE_P(All, EveryProgram, ::testing::ValuesIn(kPrograms));

class EveryProcess : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryProcess, RefusesAnUnknownParameterWithExitCode2) {
  const auto result = run_program(GetParam(), {"--set", "no_such_key=1"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("no_such_key"));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

TEST_P(EveryProcess, DumpsParametersThatItLoadsAgain) {
  const test::TemporaryDir dir;
  const auto dump = run_program(GetParam(), {"--dump-params"});
  ASSERT_EQ(dump.exit_code, 0);
  EXPECT_THAT(dump.out, HasSubstr("# "));  // the description of a parameter
  const std::string file = dir.path() / "params.yaml";
  FILE* out = std::fopen(file.c_str(), "w");
  std::fputs(dump.out.c_str(), out);
  std::fclose(out);
  const auto again = run_program(GetParam(), {"--config", file, "--dump-params"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.out, dump.out);
}

INSTANTIATE_TEST_SUITE_P(All, EveryProcess, ::testing::ValuesIn(kProcesses));

class EveryModule : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryModule, NeverOverwritesResults) {
  const test::TemporaryDir dir;
  const std::string file = dir.path() / "precious";
  write_odometry_log(file, 1);
  const auto result = run_program(GetParam(), {"--replay", file, "--out", dir.path().string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("not empty"));
}

TEST_P(EveryModule, AMissingRecordingIsAnError) {
  const test::TemporaryDir dir;
  const auto result = run_program(
      GetParam(), {"--replay", dir.path() / "none.lcmlog", "--out", dir.path() / "out"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("none.lcmlog: cannot open: No such file or directory"));
  EXPECT_FALSE(std::filesystem::exists(dir.path() / "out"));
}

// Ctrl-C also ends the `tee` to which a process writes.
TEST_P(EveryModule, WritesItsResultsAlsoWhenNobodyReadsItsLog) {
  const test::TemporaryDir dir;
  const std::filesystem::path out = dir.path() / "out";
  test::ChildProcess process(
      {NODMAP_BIN "/" + std::string(GetParam()), "--lcm-url", "memq://", "--out", out});
  ASSERT_TRUE(process.wait_for_stderr("listening on", test::kPatience)) << process.said();
  process.stop_reading();
  process.send_signal(SIGTERM);
  EXPECT_EQ(process.wait_for_end(test::kPatience), 0);
  EXPECT_TRUE(std::filesystem::exists(out / "result.json"));
}

TEST_P(EveryModule, WritesItsResultsWhenItsTerminalCloses) {
  const test::TemporaryDir dir;
  const std::filesystem::path out = dir.path() / "out";
  test::ChildProcess process(
      {NODMAP_BIN "/" + std::string(GetParam()), "--lcm-url", "memq://", "--out", out});
  ASSERT_TRUE(process.wait_for_stderr("listening on", test::kPatience)) << process.said();
  process.send_signal(SIGHUP);
  EXPECT_EQ(process.wait_for_end(test::kPatience), 0);
  EXPECT_TRUE(std::filesystem::exists(out / "result.json"));
}

class EveryModuleWithAMap : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryModuleWithAMap, AfterAMissingMapTheCorrectedCommandSucceeds) {
  const test::TemporaryDir dir;
  const std::filesystem::path log = dir.path() / "in.lcmlog";
  write_odometry_log(log, 3);
  for (const char* option : {"--localise", "--map-in"}) {
    const std::filesystem::path out = dir.path() / option;
    const auto wrong = run_program(
        GetParam(), {"--replay", log, "--out", out, option, dir.path() / "none.lcmlog"});
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_THAT(wrong.err, HasSubstr("none.lcmlog"));
    const auto corrected = run_program(GetParam(), {"--replay", log, "--out", out});
    EXPECT_EQ(corrected.exit_code, 0) << corrected.err;
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryModuleWithAMap,
                         ::testing::Values("nodmap-slam2d", "nodmap-slam6d"));

TEST_P(EveryModule, AFileThatIsNotARecordingIsAnError) {
  const test::TemporaryDir dir;
  const std::filesystem::path text = dir.path() / "notes.txt";
  std::ofstream(text) << "Nothing that LCM has written.\n";
  const auto result = run_program(GetParam(), {"--replay", text, "--out", dir.path() / "out"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("notes.txt: not an LCM event log (no event found)"));
  EXPECT_FALSE(std::filesystem::exists(dir.path() / "out"));
}

TEST_P(EveryModuleWithAMap, SaysThatItsMapIsEmpty) {
  const test::TemporaryDir dir;
  write_odometry_log(dir.path() / "in.lcmlog", 3);
  const auto result =
      run_program(GetParam(), {"--replay", dir.path() / "in.lcmlog", "--out", dir.path() / "out"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("the map is empty: no scan was used"));
}

TEST_P(EveryModule, ATruncatedRecordingIsUsedWithAWarning) {
  const test::TemporaryDir dir;
  const std::filesystem::path log = dir.path() / "cut.lcmlog";
  write_odometry_log(log, 3);
  std::filesystem::resize_file(log, std::filesystem::file_size(log) - 1);
  const auto result = run_program(GetParam(), {"--replay", log, "--out", dir.path() / "out"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(
      result.err,
      HasSubstr("bytes are not part of a complete event: the file is damaged or truncated"));
  EXPECT_THAT(result.err, Not(HasSubstr("\033"))) << "no colours, because this is not a terminal";
}

INSTANTIATE_TEST_SUITE_P(All, EveryModule, ::testing::ValuesIn(kModules));

struct ReadingCommand {
  const char* program;
  std::vector<std::string> before;  // the arguments before the file
  std::vector<std::string> after;   // the arguments after the file
};

// The words of the command, for the name of a test: letters and digits only.
std::string name_of(const ::testing::TestParamInfo<ReadingCommand>& info) {
  std::string name = info.param.program;
  for (const auto* words : {&info.param.before, &info.param.after}) {
    for (const std::string& word : *words) {
      name += "_" + word;
    }
  }
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

class EveryCommandThatReads : public ::testing::TestWithParam<ReadingCommand> {};

TEST_P(EveryCommandThatReads, ReportsAMissingFileInTheSameWords) {
  const test::TemporaryDir dir;
  const std::string missing = dir.path() / "missing";
  std::vector<std::string> arguments = GetParam().before;
  arguments.push_back(missing);
  for (const std::string& word : GetParam().after) {
    arguments.push_back(word.starts_with("new.") ? (dir.path() / word).string() : word);
  }
  const auto result = run_program(GetParam().program, arguments);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err, std::string(GetParam().program) + ": " + missing +
                            ": cannot open: No such file or directory\n");
}

INSTANTIATE_TEST_SUITE_P(
    All, EveryCommandThatReads,
    ::testing::Values(ReadingCommand{"nodmap-convert", {"info"}, {}},
                      ReadingCommand{"nodmap-convert", {"mcap"}, {"new.mcap"}},
                      ReadingCommand{"nodmap-convert", {"export"}, {"new.csv"}},
                      ReadingCommand{"nodmap-convert", {"export"}, {"new.ply"}},
                      ReadingCommand{"nodmap-convert", {"carmen"}, {"new.lcmlog"}},
                      ReadingCommand{"nodmap-convert", {"nod"}, {"new.lcmlog"}},
                      ReadingCommand{"nodmap-convert", {"uos"}, {"new.lcmlog"}},
                      ReadingCommand{"nodmap-evaluate", {"trajectory"}, {"x"}},
                      ReadingCommand{"nodmap-evaluate", {"relations", "/dev/null"}, {}},
                      ReadingCommand{"nodmap-evaluate", {"cloud", "/dev/null"}, {}},
                      ReadingCommand{"nodmap-deputy", {}, {}},
                      ReadingCommand{"nodmap-latency", {"--replay"}, {}},
                      ReadingCommand{"nodmap-sheriff", {}, {}},
                      ReadingCommand{"nodmap-sim", {"--world"}, {}},
                      ReadingCommand{"nodmap-slam2d", {"--config"}, {}},
                      ReadingCommand{"nodmap-trial", {"--world"}, {"--out", "new.d"}},
                      ReadingCommand{"nodmap-viewer", {"--replay"}, {}}),
    name_of);

class EveryCommandThatReadsLogs : public ::testing::TestWithParam<ReadingCommand> {
 protected:
  // Runs the command on `file`.
  test::ProgramResult run_on(const std::string& file) {
    std::vector<std::string> arguments = GetParam().before;
    arguments.push_back(file);
    for (const std::string& word : GetParam().after) {
      arguments.push_back(word.starts_with("new.") ? (dir_.path() / word).string() : word);
    }
    return run_program(GetParam().program, arguments);
  }

  test::TemporaryDir dir_;
};

TEST_P(EveryCommandThatReadsLogs, WarnsOfATruncatedLog) {
  const std::filesystem::path log = dir_.path() / "cut.lcmlog";
  write_odometry_log(log, 3);
  std::filesystem::resize_file(log, std::filesystem::file_size(log) - 1);
  EXPECT_THAT(
      run_on(log).err,
      HasSubstr("bytes are not part of a complete event: the file is damaged or truncated"));
}

TEST_P(EveryCommandThatReadsLogs, RefusesATextFileAndWritesNothing) {
  const std::filesystem::path text = dir_.path() / "notes.txt";
  std::ofstream(text) << "Nothing that LCM has written.\n";
  const auto result = run_on(text);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("notes.txt: not an LCM event log (no event found)"));
  const std::filesystem::directory_iterator files(dir_.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

INSTANTIATE_TEST_SUITE_P(
    All, EveryCommandThatReadsLogs,
    ::testing::Values(ReadingCommand{"nodmap-convert", {"info"}, {}},
                      ReadingCommand{"nodmap-convert", {"mcap"}, {"new.mcap"}},
                      ReadingCommand{"nodmap-convert", {"export", "--channel", "A"}, {"new.csv"}},
                      ReadingCommand{"nodmap-convert", {"export"}, {"new.ply"}},
                      ReadingCommand{"nodmap-latency", {"--replay"}, {}}),
    name_of);

}  // namespace programs_test
}  // namespace nodmap
