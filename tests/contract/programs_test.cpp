// SPDX-License-Identifier: BSD-3-Clause
// What every program promises on its command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/data_dir.hpp"
#include "tests/support/program.hpp"

namespace nodmap {
namespace {

using test::run_program;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// clang-format off
// Everything that is installed,
constexpr const char* kPrograms[] = {
    "nodmap-convert",
    "nodmap-deputy",
    "nodmap-doctor",
    "nodmap-evaluate",
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
// of that, what runs on the robot, with parameters,
constexpr const char* kProcesses[] = {
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
// and of that, what works on a recording, too.
constexpr const char* kModules[] = {
    "nodmap-map-server",
    "nodmap-navigator",
    "nodmap-pitch-controller",
    "nodmap-slam2d",
    "nodmap-slam6d",
};
// clang-format on

class EveryProgram : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryProgram, SaysWhatItIsAndWhichVersion) {
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

INSTANTIATE_TEST_SUITE_P(All, EveryProgram, ::testing::ValuesIn(kPrograms));

class EveryProcess : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryProcess, RefusesAWrongParameterWithCode2) {
  const auto result = run_program(GetParam(), {"--set", "no_such_key=1"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("no_such_key"));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

TEST_P(EveryProcess, DumpsParametersThatItLoadsAgain) {
  const test::TemporaryDir dir;
  const auto dump = run_program(GetParam(), {"--dump-params"});
  ASSERT_EQ(dump.exit_code, 0);
  EXPECT_THAT(dump.out, HasSubstr("# "));  // the sentence of a parameter
  const std::string file = dir.path() / "params.yaml";
  FILE* out = std::fopen(file.c_str(), "w");
  std::fputs(dump.out.c_str(), out);
  std::fclose(out);
  const auto again = run_program(GetParam(), {"--config", file, "--dump-params"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.out, dump.out);
}

INSTANTIATE_TEST_SUITE_P(All, EveryProcess, ::testing::ValuesIn(kProcesses));

class EveryProcessThatKnowsTheRobot : public ::testing::TestWithParam<const char*> {};

// The file says KURT3D, and so do the defaults: what it changes would be a mistake in one of them.
TEST_P(EveryProcessThatKnowsTheRobot, TakesTheFileOfTheRobot) {
  const auto defaults = run_program(GetParam(), {"--dump-params"});
  const auto told =
      run_program(GetParam(), {"--config", NODMAP_KURT3D "/robot.yaml", "--dump-params"});
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(told.out, defaults.out);
}

INSTANTIATE_TEST_SUITE_P(All, EveryProcessThatKnowsTheRobot,
                         ::testing::Values("nodmap-laser3d", "nodmap-map-server",
                                           "nodmap-navigator", "nodmap-pitch-controller"));

class EveryModule : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryModule, NeverOverwritesResults) {
  const test::TemporaryDir dir;
  const std::string file = dir.path() / "precious";
  std::fclose(std::fopen(file.c_str(), "w"));
  const auto result = run_program(GetParam(), {"--replay", file, "--out", dir.path().string()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("not empty"));
}

TEST_P(EveryModule, AMissingRecordingIsAnError) {
  const test::TemporaryDir dir;
  const auto result = run_program(
      GetParam(), {"--replay", dir.path() / "none.lcmlog", "--out", dir.path() / "out"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("none.lcmlog"));
}

INSTANTIATE_TEST_SUITE_P(All, EveryModule, ::testing::ValuesIn(kModules));

}  // namespace
}  // namespace nodmap
