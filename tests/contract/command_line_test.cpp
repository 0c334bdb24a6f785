// SPDX-License-Identifier: BSD-3-Clause
// What command lines of single programs are refused for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "common/bus/event_log.hpp"
#include "tests/support/data_dir.hpp"
#include "tests/support/program.hpp"

namespace nodmap {
namespace command_line_test {

using test::run_program;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(CommandLine, AnErrorNamesTheSubcommandAndTheNearestValidWord) {
  EXPECT_EQ(run_program("nodmap-convert", {"infoo", "x"}).err,
            "nodmap-convert: unknown subcommand 'infoo'; did you mean 'info'? (see nodmap-convert "
            "--help)\n");
  EXPECT_THAT(run_program("nodmap-convert", {"info"}).err,
              StartsWith("nodmap-convert info: IN is required"));
  // The message names the wrong option, and not its value, which counts as an argument.
  EXPECT_THAT(
      run_program("nodmap-convert", {"export", "--chanel", "X", "in", "out.csv"}).err,
      StartsWith("nodmap-convert export: unknown option '--chanel'; did you mean '--channel'?"));
  EXPECT_THAT(
      run_program("nodmap-evaluate", {"trajectory", "--aling", "x", "y"}).err,
      StartsWith("nodmap-evaluate trajectory: unknown option '--aling'; did you mean '--align'?"));
  EXPECT_THAT(run_program("nodmap-sheriff", {"--chek", "x"}).err,
              HasSubstr("did you mean '--check'?"));
  EXPECT_THAT(run_program("nodmap-sheriff", {NODMAP_KURT3D "/../../procman/robot.pmd", "--script",
                                             "start_robt", "--lcm-url", "memq://"})
                  .err,
              HasSubstr("did you mean 'start_robot'?"));
  EXPECT_THAT(run_program("nodmap-slam2d", {"--set", "max_itertions=3"}).err,
              HasSubstr("did you mean 'matcher.max_iterations'?"));
}

// systemd does not start a service again that ends with it.
TEST(WrongInput, EndsWithExitCodeTwoAndOneLine) {
  const test::TemporaryDir dir;
  const std::string text = dir.path() / "text";
  const std::string empty = dir.path() / "empty";
  const std::string log = dir.path() / "log";
  std::ofstream(text) << "neither a trajectory nor a cloud\n";
  const std::ofstream nothing(empty);
  ASSERT_TRUE(bus::LogWriter(log).write(1, "NOT_OURS", {}));
  const std::vector<std::string> commands = {
      "NODMAP_TRUSTED_HOSTS=robot " NODMAP_BIN
      "/nodmap-map-server --lcm-url 'udpm://239.255.76.67:7667?ttl=0'",
      NODMAP_BIN "/nodmap-map-server --lcm-url 'udpm://239.255.76.67:7667?tttl=1'",
      NODMAP_BIN "/nodmap-evaluate trajectory " + text + " " + text,
      NODMAP_BIN "/nodmap-evaluate relations " + text + " " + text,
      NODMAP_BIN "/nodmap-trial --out " + dir.path().string() + "/t --world nosuch:1",
      NODMAP_BIN "/nodmap-trial --out " + dir.path().string() + "/t --world barn:" + text + ":1",
      NODMAP_BIN "/nodmap-trial --out " + dir.path().string() + "/t --world pedestrians:" + text +
          ":15:1",
      NODMAP_BIN "/nodmap-trial --out " + dir.path().string() + "/t --world maze:1 --fault x",
      NODMAP_BIN "/nodmap-trial --out " + dir.path().string() + "/t --world maze:1 --kill x",
      NODMAP_BIN "/nodmap-trial --out " + dir.path().string() +
          "/t --world maze:1 --set laser3d.nod.default_min_deg=50",
      NODMAP_BIN "/nodmap-logger --out " + text,
      NODMAP_BIN "/nodmap-logger --out " + dir.path().string() + " --file ..",
      NODMAP_BIN "/nodmap-sim --lcm-url memq:// --world maze:1 --links " + text,
      NODMAP_BIN
      "/nodmap-navigator --lcm-url memq:// "
      "--set robot.braking.emergency_deceleration_mps2=0.5",
      NODMAP_BIN "/nodmap-navigator --lcm-url memq:// --set drive.creep_margin_m=0.5",
      NODMAP_BIN "/nodmap-trial --out " + dir.path().string() +
          "/t --world maze:1 --set navigator.drive.creep_margin_m=0.5",
      NODMAP_BIN "/nodmap-slam6d --lcm-url memq:// --set range.max_m=0.5",
      NODMAP_BIN "/nodmap-slam6d --lcm-url memq:// --set sweep.max_scans=9",
      NODMAP_BIN "/nodmap-slam6d --lcm-url memq:// --set registration.coarse_residual_scale_m=0.01",
      NODMAP_BIN "/nodmap-slam6d --lcm-url memq:// --set mount.max_error_deg=0.1",
      NODMAP_BIN "/nodmap-trial --out " + dir.path().string() +
          "/t --world maze:1 --set slam6d.range.max_m=0.5",
      NODMAP_BIN "/nodmap-evaluate cloud " + text +
          " " NODMAP_KURT3D "/../../sim/worlds/cellar.yaml --start 0 0 0",
      NODMAP_BIN "/nodmap-evaluate trajectory " + empty + " " + empty,
      NODMAP_BIN "/nodmap-evaluate relations " + empty + " " + empty,
      NODMAP_BIN "/nodmap-evaluate cloud " + empty + " barn:" + text,
      NODMAP_BIN "/nodmap-convert carmen " + empty + " " + empty,
      NODMAP_BIN "/nodmap-convert carmen " + empty + " " + text + ".lcmlog",
      NODMAP_BIN "/nodmap-convert uos " + dir.path().string() + " " + text + ".lcmlog",
      NODMAP_BIN "/nodmap-convert export " + log + " " + text + ".ply",
      NODMAP_BIN "/nodmap-convert export " + log + " " + text + ".clf",
      NODMAP_BIN "/nodmap-convert export --channel POSE_2D " + log + " " + text + ".csv",
      NODMAP_BIN "/nodmap-convert mcap " + log + " " + text + ".mcap"};
  for (const std::string& command : commands) {
    const auto result = run_program("sh", {"-c", command});
    EXPECT_EQ(result.exit_code, 2) << command << ": " << result.err;
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  }
}

TEST(Save, SaysWhenNobodyListens) {
  const auto result = run_program("nodmap-save", {"--lcm-url", "memq://"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("nobody listens"));
}

TEST(Clear, SaysWhenNobodyListens) {
  const auto result =
      run_program("nodmap-clear", {"--lcm-url", "memq://", "--wait", "0.1", "1", "-2", "0", "3"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("nobody listens"));
}

TEST(Clear, RefusesWhatIsNoRectangle) {
  for (const std::vector<std::string>& corners : std::vector<std::vector<std::string>>{
           {"1", "-2", "0"}, {"1", "1", "1", "5"}, {"0", "0", "nan", "1"}}) {
    std::vector<std::string> arguments{"--lcm-url", "memq://", "--wait", "0.1"};
    arguments.insert(arguments.end(), corners.begin(), corners.end());
    EXPECT_EQ(run_program("nodmap-clear", arguments).exit_code, 2) << corners.size();
  }
}

// A time that is not a number never passes, and no distance is within it.
TEST(Numbers, MustBeFinite) {
  const std::vector<std::vector<std::string>> commands = {
      {"nodmap-slam2d", "--localise", "y", "--start-pose", "nan", "0", "0"},
      {"nodmap-goal", "3", "1", "--heading", "nan"},
      {"nodmap-goal", "3", "nan"},
      {"nodmap-stop", "--wait", "NaN"},
      {"nodmap-watch", "--duration", "nan"},
      {"nodmap-trial", "--duration", "-nan"},
      {"nodmap-trial", "--appear", "-1"},
      {"nodmap-latency", "--duration", "nan(1)"},
      {"nodmap-convert", "export", "x.lcmlog", "x.ply", "--start-s", "nan"},
      {"nodmap-evaluate", "cloud", "x.ply", "cellar", "--start", "0", "nan", "0"},
      {"nodmap-evaluate", "cloud", "x.ply", "cellar", "--start", "0", "inf", "0"},
  };
  for (const std::vector<std::string>& command : commands) {
    const auto result = run_program(command.front(), {command.begin() + 1, command.end()});
    EXPECT_EQ(result.exit_code, 2) << command.front();
    EXPECT_THAT(result.err,
                AnyOf(HasSubstr("is not a finite number"), HasSubstr("is not a number")))
        << command.front();
  }
}

// The navigator or 2D SLAM would refuse it only later, and without a word here.
TEST(Places, BeyondTenKilometresAreRefused) {
  EXPECT_THAT(run_program("nodmap-goal", {"1e300", "2"}).err,
              HasSubstr("'1e300' is not a number from -10000 to 10000"));
  EXPECT_THAT(run_program("nodmap-clear", {"-1e300", "-1e300", "1e300", "1e300"}).err,
              HasSubstr("'-1e300' is not a number from -10000 to 10000"));
}

TEST(Goal, NeedsAWaypointOrHome) {
  const auto result = run_program("nodmap-goal", {"--lcm-url", "memq://"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, StartsWith("nodmap-goal: WAYPOINTS or --home is required"));
  const auto home = run_program("nodmap-goal", {"--home", "--wait", "0.1", "--lcm-url", "memq://"});
  EXPECT_EQ(home.exit_code, 1) << home.err;
  EXPECT_THAT(home.err, HasSubstr("no nodmap-navigator has reported"));
}

// And not with all 309 digits of the largest number.
TEST(Numbers, AnErrorSaysWhatIsAllowed) {
  const std::string not_below_zero = "is not a number of 0 or more";
  EXPECT_THAT(run_program("nodmap-sim", {"--duration", "1,5"}).err,
              StartsWith("nodmap-sim: --duration: '1,5' " + not_below_zero));
  EXPECT_THAT(run_program("nodmap-watch", {"--duration", "-1"}).err,
              HasSubstr("'-1' " + not_below_zero));
  EXPECT_THAT(
      run_program("nodmap-evaluate", {"trajectory", "x", "y", "--tolerance-s", "0.05s"}).err,
      HasSubstr("'0.05s' " + not_below_zero));
  EXPECT_THAT(run_program("nodmap-latency", {"--duration", "0"}).err,
              HasSubstr("'0' is not a number above 0"));
  EXPECT_THAT(run_program("nodmap-trial", {"--duration", "abc"}).err,
              HasSubstr("--duration: 'abc' is not a number from 0.1 to 86400 "));
  EXPECT_THAT(run_program("nodmap-viewer", {"--port", "99999"}).err,
              HasSubstr("--port: '99999' is not a number that it can take"));
}

TEST(Trial, NamesTheRobotsItKnows) {
  EXPECT_THAT(run_program("nodmap-trial", {"--help"}).out, HasSubstr("{kurt3d,jackal}"));
  EXPECT_THAT(run_program("nodmap-trial", {"--robot", "jakcal"}).err,
              StartsWith("nodmap-trial: --robot: jakcal not in {kurt3d,jackal}"));
}

// They would all be the same seed.
TEST(Seeds, MustNotWrapAround) {
  for (const char* seed : {"-1", "18446744073709551616", "99999999999999999999"}) {
    for (const char* program : {"nodmap-sim", "nodmap-trial"}) {
      const auto result = run_program(program, {"--world", "x", "--out", "x", "--seed", seed});
      EXPECT_EQ(result.exit_code, 2) << seed;
      EXPECT_THAT(result.err, HasSubstr(std::string("--seed: '") + seed)) << program;
    }
  }
}

// A script's variable that is not set must not make a live run of a replay.
TEST(Texts, MustNotBeEmpty) {
  const std::vector<std::vector<std::string>> commands = {
      {"nodmap-navigator", "--out", "x", "--replay", ""},
      {"nodmap-slam2d", "--replay", "x.lcmlog", "--out", ""},
      {"nodmap-slam2d", "--localise", ""},
      {"nodmap-slam6d", "--map-in", ""},
      {"nodmap-map-server", "--config", ""},
      {"nodmap-explorer", "--set", ""},
      {"nodmap-latency", "--replay", ""},
      {"nodmap-viewer", "--control", "--procman", ""},
      {"nodmap-logger", "--file", ""},
      {"nodmap-stop", "--lcm-url", ""},
      {"nodmap-convert", "export", "x.lcmlog", "x.csv", "--channel", ""},
      {"nodmap-convert", "info", ""},
  };
  for (const std::vector<std::string>& command : commands) {
    const auto result = run_program(command.front(), {command.begin() + 1, command.end()});
    EXPECT_EQ(result.exit_code, 2) << command.front();
    EXPECT_THAT(result.err, HasSubstr("needs a value")) << command.front();
  }
}

TEST(Trial, RefusesOptionsThatContradictEachOther) {
  const std::vector<std::vector<std::string>> arguments = {
      {"--explore", "--without", "explorer"},
      {"--explore", "--without", "slam2d"},
      {"--localise", "x", "--without", "slam2d"},
      {"--map-in", "x", "--without", "slam2d"},
      {"--pitch", "fixed", "--set", "pitch_controller.mode=nodding"},
      {"--robot", "jackal", "--pitch", "nodding"},
      {"--robot", "jackal", "--fault", "servo:stall@1+1"},
  };
  for (const std::vector<std::string>& contradiction : arguments) {
    std::vector<std::string> command{"--world", "none.yaml", "--out", "x"};
    command.insert(command.end(), contradiction.begin(), contradiction.end());
    const auto result = run_program("nodmap-trial", command);
    EXPECT_EQ(result.exit_code, 2) << contradiction.back();
    EXPECT_THAT(result.err, StartsWith("nodmap-trial: " + contradiction.front()))
        << "not that the world is missing";
  }
}

TEST(Options, ThatWouldHaveNoEffectAreRefused) {
  const std::vector<std::vector<std::string>> commands = {
      {"nodmap-goal", "3", "1", "--heading-tolerance", "2"},
      {"nodmap-latency", "--duration", "2", "--replay", "x.lcmlog"},
      {"nodmap-convert", "export", "x.lcmlog", "x.clf", "--channel", "SCAN"},
      {"nodmap-convert", "export", "x.lcmlog", "x.ply", "--channel", "SCAN"},
      {"nodmap-convert", "export", "x.lcmlog", "x.csv", "--start-s", "2"},
      {"nodmap-convert", "export", "x.lcmlog", "x.tum", "--scans", "2"},
  };
  for (const std::vector<std::string>& command : commands) {
    const auto result = run_program(command.front(), {command.begin() + 1, command.end()});
    EXPECT_EQ(result.exit_code, 2) << command.front();
    EXPECT_THAT(result.err, HasSubstr("--")) << command.front();
    EXPECT_THAT(result.err, Not(HasSubstr("x.lcmlog"))) << "not that the file is missing";
  }
}

}  // namespace command_line_test
}  // namespace nodmap
