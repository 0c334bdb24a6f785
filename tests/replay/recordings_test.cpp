// SPDX-License-Identifier: BSD-3-Clause
// The modules on real recordings: how accurate they are, and that two runs give the same bytes.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "common/formats/tum.hpp"
#include "tests/support/data_dir.hpp"
#include "tests/support/program.hpp"

namespace nodmap {
namespace recordings_test {

namespace fs = std::filesystem;
using test::run_program;
using test::slurp;

void expect_ok(const test::ProgramResult& result) {
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

void replay(const std::string& program, const fs::path& log, const fs::path& out) {
  expect_ok(run_program(program, {"--replay", log, "--out", out}));
}

void expect_same_bytes(const fs::path& a, const fs::path& b, const std::string& file) {
  EXPECT_FALSE(slurp(a / file).empty()) << file;
  EXPECT_TRUE(slurp(a / file) == slurp(b / file)) << file << " differs between two runs";
}

struct Log2d {
  const char* name;
  double bound_m;    // of the mean translation error
  double bound_deg;  // of the mean rotation error
};

class Slam2dOnRecording : public ::testing::TestWithParam<Log2d> {};

// The bounds are 1.25 times the measured errors: 0.0126 m and 0.206 degrees, 0.0300 m and 0.420,
// 0.0267 m and 0.328. Plain scan matching had 0.22, 0.26 and 0.11 m in Kuemmerle et al. 2009.
TEST_P(Slam2dOnRecording, ErrorsOfTheRelationsAreWithinTheBounds) {
  const std::string name = GetParam().name;
  NODMAP_REQUIRE_DATA(clf, "slam2d/" + name + ".clf");
  const test::TemporaryDir dir;
  const fs::path log = dir.path() / "in.lcmlog";
  expect_ok(run_program("nodmap-convert", {"carmen", clf, log}));
  replay("nodmap-slam2d", log, dir.path() / "out");
  const auto evaluation =
      run_program("nodmap-evaluate", {"relations", dir.path() / "out" / "trajectory.tum",
                                      clf.parent_path() / (name + ".relations")});
  expect_ok(evaluation);
  const auto error = nlohmann::json::parse(evaluation.out);
  EXPECT_EQ(error["missing"], 0);
  EXPECT_LE(error["trans_mean_m"], GetParam().bound_m);
  EXPECT_LE(error["rot_mean_deg"], GetParam().bound_deg);
  RecordProperty("trans_mean_m", error["trans_mean_m"].dump());
  RecordProperty("rot_mean_deg", error["rot_mean_deg"].dump());
}

INSTANTIATE_TEST_SUITE_P(Logs, Slam2dOnRecording,
                         ::testing::Values(Log2d{"intel", 0.0157, 0.257},
                                           Log2d{"fr079", 0.0375, 0.525},
                                           Log2d{"mit-csail", 0.0333, 0.41}),
                         [](const auto& log) {
                           std::string name = log.param.name;
                           std::erase(name, '-');
                           return name;
                         });

TEST(ReplayTwice, Slam2dAndMapServerGiveTheSameBytes) {
  NODMAP_REQUIRE_DATA(clf, "slam2d/mit-csail.clf");
  const test::TemporaryDir dir;
  const fs::path log = dir.path() / "in.lcmlog";
  expect_ok(run_program("nodmap-convert", {"carmen", clf, log}));
  for (const std::string program : {"nodmap-slam2d", "nodmap-map-server"}) {
    const fs::path a = dir.path() / (program + "-a");
    const fs::path b = dir.path() / (program + "-b");
    replay(program, log, a);
    replay(program, log, b);
    expect_same_bytes(a, b, "out.lcmlog");
    if (program == "nodmap-slam2d") {
      expect_same_bytes(a, b, "trajectory.tum");
      expect_same_bytes(a, b, "online.tum");
      expect_same_bytes(a, b, "map.pgm");
    }
  }
}

class Slam6dOnKurt3d : public ::testing::Test {
 protected:
  void convert_and_replay(const fs::path& scans) {
    expect_ok(run_program("nodmap-convert", {"uos", scans, log_}));
    replay("nodmap-slam6d", log_, out_);
  }

  test::TemporaryDir dir_;
  fs::path log_ = dir_.path() / "in.lcmlog";
  fs::path out_ = dir_.path() / "out";
};

TEST_F(Slam6dOnKurt3d, ThreeKeyframesAndTheSameBytesTwice) {
  NODMAP_REQUIRE_DATA(scans, "kurt3d");
  convert_and_replay(scans);
  const auto result = nlohmann::json::parse(slurp(out_ / "result.json"));
  EXPECT_EQ(result["metrics"]["keyframes"].size(), 3U);
  EXPECT_EQ(formats::read_tum(out_ / "trajectory.tum").size(), 3U);
  replay("nodmap-slam6d", log_, dir_.path() / "again");
  for (const char* file : {"out.lcmlog", "trajectory.tum", "online.tum", "cloud.ply", "map.bt"}) {
    expect_same_bytes(out_, dir_.path() / "again", file);
  }
}

// The number of plane hits and the median distance in each of the two lines of
// nodmap-bench-kurt3d-planes, or of plane_residual.
struct Residual {
  double planes_hit = 0.0;
  double median_cm = 0.0;
};

std::vector<Residual> parse_residuals(const std::string& text) {
  std::vector<Residual> residuals;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    Residual residual;
    int scan = 0;
    int model = 0;
    if (std::sscanf(line.c_str(), "scan %d on %d: planes hit %lf, residual median %lf", &scan,
                    &model, &residual.planes_hit, &residual.median_cm) == 4) {
      residuals.push_back(residual);
    }
  }
  return residuals;
}

constexpr const char* kPlanes = "nodmap-bench-kurt3d-planes";

// Measured: 1.93 and 1.86 cm, with 0.356 and 0.464 of the points on a plane. Fewer would make it
// too easy.
TEST_F(Slam6dOnKurt3d, ScansAgreeAtLeastAsWellAsIn3dtksResultOf2009) {
  NODMAP_REQUIRE_DATA(scans, "kurt3d");
  convert_and_replay(scans);
  const auto run = run_program(kPlanes, {scans, out_ / "trajectory.tum"});
  expect_ok(run);
  const auto residuals = parse_residuals(run.out);
  ASSERT_EQ(residuals.size(), 2U) << run.out;
  EXPECT_LE(residuals[0].median_cm, 2.10);
  EXPECT_LE(residuals[1].median_cm, 2.07);
  EXPECT_GE(residuals[0].planes_hit, 0.35);
  EXPECT_GE(residuals[1].planes_hit, 0.46);
}

// plane_residual is independent of our code: it is compiled from sources beside the data. One in
// the last digit: the two take the median of an even number of distances in different ways.
TEST(Kurt3dPlanes, AnIndependentProgramMeasuresTheSame) {
  NODMAP_REQUIRE_DATA(scans, "kurt3d");
  NODMAP_REQUIRE_DATA(source, "../tools/plane_residual.cpp");
  const test::TemporaryDir dir;
  const std::string program = dir.path() / "plane_residual";
  expect_ok(
      run_program("g++", {"-O2", "-std=c++17", "-I/usr/include/eigen3", source, "-o", program}));
  for (const auto& [ours, theirs] : {std::pair("odometry", "--pose"), {"3dtk", "--frames"}}) {
    const auto found = parse_residuals(run_program(kPlanes, {scans, ours}).out);
    const auto expected = parse_residuals(run_program(program, {scans, theirs}).out);
    ASSERT_EQ(found.size(), 2U);
    ASSERT_EQ(expected.size(), 2U);
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_NEAR(found[k].median_cm, expected[k].median_cm, 0.011) << ours << " " << k;
      EXPECT_NEAR(found[k].planes_hit, expected[k].planes_hit, 0.0011) << ours << " " << k;
    }
  }
}

}  // namespace recordings_test
}  // namespace nodmap
