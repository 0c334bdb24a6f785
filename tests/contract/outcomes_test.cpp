// SPDX-License-Identifier: BSD-3-Clause
// What single programs say, and with which exit code they end, when there is nothing to use or
// nowhere to write.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "common/bus/event_log.hpp"
#include "tests/contract/odometry_log.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/data_dir.hpp"
#include "tests/support/program.hpp"

namespace nodmap {
namespace outcomes_test {

using test::run_program;
using test::write_odometry_log;
using ::testing::HasSubstr;

TEST(Localisation, SaysThatTheRobotWasNotFound) {
  const test::TemporaryDir dir;
  write_odometry_log(dir.path() / "in.lcmlog", 3);
  std::ofstream(dir.path() / "map.yaml") << "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n";
  std::ofstream(dir.path() / "map.pgm") << "P2 3 1 255 0 254 254\n";
  const auto result = run_program("nodmap-slam2d", {"--replay", dir.path() / "in.lcmlog", "--out",
                                                    dir.path() / "out", "--localise", dir.path()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("the robot was not found in the saved map"));
}

// Everything is nearer than range.min_m.
TEST(SmallScene, IsRefusedWithTheParametersThatRefuseIt) {
  NODMAP_REQUIRE_DATA(recording, "tilting/cardboard_box.nod");
  const test::TemporaryDir dir;
  const std::string log = dir.path() / "box.lcmlog";
  ASSERT_EQ(run_program("nodmap-convert", {"nod", recording, log}).exit_code, 0);
  const auto result = run_program(
      "nodmap-slam6d", {"--replay", log, "--assume-stationary", "--out", dir.path() / "out"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("the map is empty: none of 2 sweeps"));
  EXPECT_THAT(result.err, HasSubstr("range.min_m = 0.5 m"));
}

// The corrected command must not find the folder of the failed one.
TEST(Trial, LeavesNoFolderIfItCannotBegin) {
  const test::TemporaryDir dir;
  const std::string out = dir.path() / "out";
  const auto result = run_program(
      "nodmap-trial", {"--world", "maze:1", "--out", out, "--localise", dir.path() / "none"});
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_TRUE(std::filesystem::is_empty(dir.path()));
}

TEST(Latency, SaysWhyItHasNothingToMeasure) {
  const test::TemporaryDir dir;
  write_odometry_log(dir.path() / "in.lcmlog", 3);
  const auto result = run_program("nodmap-latency", {"--replay", dir.path() / "in.lcmlog"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("no SCAN was followed by an OBSTACLE_MAP"));
}

// A table or a file of parameters that ends in the middle passes for a whole one.
TEST(Output, ThatCannotBeWrittenIsAnError) {
  const test::TemporaryDir dir;
  const std::string log = dir.path() / "in.lcmlog";
  write_odometry_log(log, 3);
  for (const std::string& command : {std::string("slam2d --dump-params"),
                                     std::string("evaluate --help"), "convert info " + log}) {
    const auto result = run_program("sh", {"-c", NODMAP_BIN "/nodmap-" + command + " >/dev/full"});
    EXPECT_EQ(result.exit_code, 1) << command;
    EXPECT_THAT(result.err, HasSubstr("cannot write to stdout"));
  }
}

// It waits for somebody who writes to its input, so it has set its handlers, if any.
TEST(Evaluate, ASignalEndsItAtOnce) {
  const test::TemporaryDir dir;
  const std::string pipe = dir.path() / "pipe.tum";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  test::ChildProcess process({NODMAP_BIN "/nodmap-evaluate", "trajectory", pipe, pipe});
  const std::ofstream writer(pipe);  // opens when the reader does
  process.send_signal(SIGINT);
  EXPECT_EQ(process.wait_for_end(test::kPatience), 128 + SIGINT) << process.said();
}

TEST(Evaluate, SaysWhichFileIsEmpty) {
  const test::TemporaryDir dir;
  const std::string empty = dir.path() / "empty";
  const std::string path = dir.path() / "path.tum";
  std::ofstream(empty) << "# nothing\n";
  std::ofstream(path) << "1 0 0 0 0 0 0 1\n";
  EXPECT_THAT(run_program("nodmap-evaluate", {"relations", path, empty}).err,
              HasSubstr(empty + ": contains no relation"));
  EXPECT_THAT(run_program("nodmap-evaluate", {"trajectory", path, empty}).err,
              HasSubstr(empty + ": contains no pose"));
  const std::string map = dir.path() / "map.yaml";
  std::ofstream(map) << "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n";
  std::ofstream(dir.path() / "map.pgm") << "P2 3 1 255 0 254 254\n";
  EXPECT_THAT(run_program("nodmap-evaluate", {"relocalise", map, path, empty}).err,
              HasSubstr(empty + ": contains no pose"));
  EXPECT_THAT(run_program("nodmap-evaluate", {"relocalise", map, path, path}).err,
              HasSubstr(path + ": not an LCM event log"));
}

TEST(Convert, SaysWhichFileContainsNothingAndWhatItContainsInstead) {
  const test::TemporaryDir dir;
  const std::string in = dir.path() / "nodding.clf";
  std::ofstream(in) << "NOD 1\nNOD 2\nSLICE 1\n\n";
  EXPECT_THAT(
      run_program("nodmap-convert", {"carmen", in, dir.path() / "out.lcmlog"}).err,
      HasSubstr(in + ": contains nothing that can be used: no line of a scanner or of ODOM; "
                     "its lines begin with 'NOD', 'SLICE'"));
  EXPECT_THAT(run_program("nodmap-convert", {"uos", dir.path(), dir.path() / "out.lcmlog"}).err,
              HasSubstr(dir.path().string() + ": contains nothing that can be used"));
}

TEST(Convert, SaysThatItCannotReadAPipeTwice) {
  const test::TemporaryDir dir;
  const std::string out = dir.path() / "out.lcmlog";
  const auto result = run_program("sh", {"-c", "echo ODOM 0 0 0 0 0 0 1 host 1 | " NODMAP_BIN
                                               "/nodmap-convert carmen /dev/stdin " +
                                                   out});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("/dev/stdin: not a regular file; a CARMEN log is read twice"));
}

TEST(Convert, NamesTheChannelsThatExistAndThoseThatDoNotFit) {
  const test::TemporaryDir dir;
  const std::string log = dir.path() / "in.lcmlog";
  write_odometry_log(log, 3);
  const auto missing = run_program(
      "nodmap-convert", {"export", log, dir.path() / "out.csv", "--channel", "ODOMETER"});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.err,
              HasSubstr(log + ": contains no message of channel ODOMETER, but of ODOMETRY\n"));
  ASSERT_TRUE(bus::LogWriter(dir.path() / "map.lcmlog").write(1, "MAP_2D", {}));
  const auto other = run_program("nodmap-convert", {"export", dir.path() / "map.lcmlog",
                                                    dir.path() / "out.csv", "--channel", "MAP_2D"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("channel MAP_2D contains no valid message of a type that"));
}

// The limit of a file's size stands for a full disk.
TEST(Convert, SaysWhyItCouldNotWriteEverythingAndLeavesNothing) {
  const test::TemporaryDir dir;
  const std::string log = dir.path() / "in.lcmlog";
  const std::string carmen = dir.path() / "in.clf";
  write_odometry_log(log, 1000);
  ASSERT_EQ(run_program("nodmap-convert", {"export", log, carmen}).exit_code, 0);
  for (const std::string& command :
       {"export " + log + " out.csv --channel ODOMETRY", "export " + log + " out.clf",
        "export " + log + " out.tum", "mcap " + log + " out.mcap",
        "carmen " + carmen + " out.lcmlog"}) {
    const auto result = run_program(
        "sh",
        {"-c", "cd " + dir.path().string() +
                   "; trap '' XFSZ; ulimit -f 8; exec " NODMAP_BIN "/nodmap-convert " + command});
    EXPECT_EQ(result.exit_code, 1) << command;
    EXPECT_THAT(result.err, HasSubstr("cannot write: File too large")) << command;
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << "and no success: " << result.err;
  }
  const std::filesystem::directory_iterator files(dir.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 2) << "only the inputs";
}

TEST(Convert, SaysAtOnceWhyItCannotWrite) {
  const test::TemporaryDir dir;
  std::ofstream(dir.path() / "in.lcmlog") << "Not even looked at.\n";
  for (const char* name : {"x.csv", "x.clf", "x.tum", "x.ply"}) {
    const std::string out = dir.path() / "none" / name;
    const auto result = run_program("nodmap-convert", {"export", dir.path() / "in.lcmlog", out});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr(out + ": cannot write: No such file or directory"));
  }
}

}  // namespace outcomes_test
}  // namespace nodmap
