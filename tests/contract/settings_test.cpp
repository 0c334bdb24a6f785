// SPDX-License-Identifier: BSD-3-Clause
// The configuration files of the KURT3D, as its programs read them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.hpp"

namespace nodmap {
namespace settings_test {

using test::run_program;
using ::testing::HasSubstr;

std::vector<std::string> lines_of(std::istream&& text) {
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) {
    lines.push_back(line);
  }
  return lines;
}

class EveryProcessThatKnowsTheRobot : public ::testing::TestWithParam<const char*> {};

// The file describes the KURT3D, and so do the defaults: a difference would be an error in one of
// them.
TEST_P(EveryProcessThatKnowsTheRobot, LoadingTheFileOfTheRobotChangesNoDefault) {
  const auto defaults = run_program(GetParam(), {"--dump-params"});
  const auto told =
      run_program(GetParam(), {"--config", NODMAP_KURT3D "/robot.yaml", "--dump-params"});
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(told.out, defaults.out);
}

INSTANTIATE_TEST_SUITE_P(All, EveryProcessThatKnowsTheRobot,
                         ::testing::Values("nodmap-explorer", "nodmap-laser3d", "nodmap-map-server",
                                           "nodmap-navigator", "nodmap-pitch-controller",
                                           "nodmap-viewer"));

// SAFETY.md names this speed.
TEST(Kurt3d, ItsFileLimitsTheSpeedOfTheWheels) {
  const auto params =
      run_program("nodmap-kurt", {"--config", NODMAP_KURT3D "/kurt.yaml", "--dump-params"});
  EXPECT_EQ(params.exit_code, 0) << params.err;
  EXPECT_THAT(params.out, HasSubstr("max_speed_mps: 1.8\n"));
}

// A default in the file as well would have to be changed twice.
TEST(Kurt3d, TheFilesOfItsDriversContainOnlyValuesThatDifferFromTheDefaults) {
  for (const std::string driver : {"kurt", "laser3d"}) {
    const std::string file = NODMAP_KURT3D "/" + driver + ".yaml";
    const std::string program = "nodmap-" + driver;
    const auto dump = [&](const std::vector<std::string>& args) {
      return lines_of(std::istringstream(run_program(program, args).out));
    };
    const auto defaults = dump({"--dump-params"});
    const auto told = dump({"--config", file, "--dump-params"});
    ASSERT_EQ(told.size(), defaults.size());
    std::ptrdiff_t differing = 0;
    for (std::size_t i = 0; i < told.size(); ++i) {
      differing += told[i] != defaults[i] ? 1 : 0;
    }
    const auto settings = lines_of(std::ifstream(file));
    const auto num_values = std::ranges::count_if(settings, [](const std::string& line) {
      return line.find(": ") != std::string::npos && line[line.find_first_not_of(' ')] != '#';
    });
    EXPECT_EQ(differing, num_values) << file;
  }
}

TEST(Kurt3d, ADriverNamesTheSerialPortThatItIsNotTold) {
  const auto base = run_program("nodmap-kurt", {});
  EXPECT_EQ(base.exit_code, 2);
  EXPECT_THAT(base.err, HasSubstr("device: is not set"));
  const auto laser = run_program("nodmap-laser3d", {"--set", "servo.device=/dev/servo"});
  EXPECT_EQ(laser.exit_code, 2);
  EXPECT_THAT(laser.err, HasSubstr("laser.device: is not set"));
  const auto servo = run_program("nodmap-laser3d", {"--set", "laser.device=/dev/scanner"});
  EXPECT_EQ(servo.exit_code, 2);
  EXPECT_THAT(servo.err, HasSubstr("servo.device: is not set"));
}

}  // namespace settings_test
}  // namespace nodmap
