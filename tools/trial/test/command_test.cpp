// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nodmap::trial {
namespace command_test {

using ::testing::HasSubstr;
using ::testing::StartsWith;

template <class Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(Command, ReadsAKill) {
  const Kill kill = parse_kill("pitch_controller@10.5+2");
  EXPECT_EQ(kill.process, "pitch_controller");
  EXPECT_EQ(kill.begin, time::SteadyTime(10'500ms));
  EXPECT_EQ(kill.duration, 2s);
}

TEST(Command, RefusesInvalidKills) {
  for (const char* text :
       {"", "navigator", "navigator@1", "navigator@+1", "navigator@1+", "navigator@1+0",
        "navigator@-1+1", "navigator@1+nan", "nobody@1+1", "navigator@1+1s", "@1+1"}) {
    EXPECT_THAT(error_of([text] { (void)parse_kill(text); }), HasSubstr("--kill")) << text;
  }
}

TEST(Command, RefusesToKillAProcessThatDoesNotRun) {
  TrialSetup setup;
  setup.kills = {parse_kill("navigator@1+1"), parse_kill("explorer@1+1")};
  EXPECT_THAT(error_of([&] { check_kills(setup); }), HasSubstr("explorer"));
  setup.explores = true;
  EXPECT_EQ(error_of([&] { check_kills(setup); }), "");
  setup.without = {"navigator"};
  EXPECT_THAT(error_of([&] { check_kills(setup); }), HasSubstr("navigator"));
}

TEST(AllParams, SetsAParameterOfAProcess) {
  AllParams params;
  params.set_assignment("slam2d.grid.publish_period_s=7");
  EXPECT_EQ(params.slam2d.grid.publish_period_s, 7.0);
  params.set_assignment("sim.odometry_scale_bias=0.03");
  EXPECT_EQ(params.sim.model.drive.odometry_scale_bias, 0.03);
}

TEST(AllParams, AnErrorSaysOfWhichPartItIs) {
  AllParams params;
  const auto error_after = [&params](const char* assignment) {
    return error_of([&] { params.set_assignment(assignment); });
  };
  EXPECT_THAT(error_after("foo.bar=1"),
              StartsWith("--set foo.bar=1: must begin with one of these and a dot: loop, world, "));
  EXPECT_THAT(error_after("key=1.5"), StartsWith("--set key=1.5: must begin with one of these"));
  EXPECT_THAT(error_after("pitch_controller.mode=x"),
              StartsWith("--set pitch_controller: key 'mode': 'x' is not allowed"));
  EXPECT_THAT(error_after("slam2d.no_such=1"),
              StartsWith("--set slam2d: unknown key 'no_such' with value '1'"));
  EXPECT_EQ(error_after("slam2d.key"), "--set: 'slam2d.key' is not of the form process.key=value");
}

}  // namespace command_test
}  // namespace nodmap::trial
