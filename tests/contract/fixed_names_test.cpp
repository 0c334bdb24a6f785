// SPDX-License-Identifier: BSD-3-Clause
// Keys of JSON and options by which scripts of users read and run the programs. They may become
// more, but none of them is renamed or removed.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/contract/odometry_log.hpp"
#include "tests/support/data_dir.hpp"
#include "tests/support/program.hpp"

namespace nodmap {
namespace fixed_names_test {

using nlohmann::json;
using test::run_program;

json output_of(const std::string& program, const std::vector<std::string>& arguments) {
  const auto result = run_program(program, arguments);
  EXPECT_EQ(result.exit_code, 0) << program << ": " << result.err;
  return json::parse(result.out, nullptr, false);
}

void expect_keys(const json& object, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) {
    EXPECT_TRUE(object.contains(key)) << key << " is missing in " << object.dump(2);
  }
}

TEST(Trial, KeysOfItsResult) {
  const test::TemporaryDir dir;
  const auto trial = run_program("nodmap-trial", {"--world", "maze:0", "--seed", "1", "--duration",
                                                  "1", "--out", dir.path() / "out"});
  ASSERT_EQ(trial.exit_code, 0) << trial.err;
  const json result = json::parse(test::slurp(dir.path() / "out" / "result.json"));
  expect_keys(result, {"collisions",
                       "first_collision_s",
                       "bumped",
                       "distance_m",
                       "duration_s",
                       "mean_speed_mps",
                       "max_speed_mps",
                       "min_clearance_m",
                       "goal_reached",
                       "goal_time_s",
                       "brake_latency_ms",
                       "sweep_s",
                       "slam2d",
                       "slam6d",
                       "odometry",
                       "realtime_factor",
                       "first_motion_s",
                       "contacts_caused",
                       "falls",
                       "seen_share",
                       "goals"});
  expect_keys(result["goals"], {"asked", "reached", "refused"});
  expect_keys(result["brake_latency_ms"], {"p50", "p99", "max"});
  expect_keys(result["sweep_s"], {"p50", "p99"});
  EXPECT_TRUE(std::filesystem::exists(dir.path() / "out" / "trial.lcmlog"));
  EXPECT_TRUE(std::filesystem::exists(dir.path() / "out" / "path.png"));
}

TEST(Modules, KeysOfTheirResults) {
  const test::TemporaryDir dir;
  test::write_odometry_log(dir.path() / "in.lcmlog", 3);
  for (const std::string module : {"map-server", "slam2d", "slam6d", "navigator"}) {
    const std::filesystem::path out = dir.path() / module;
    const auto replay =
        run_program("nodmap-" + module, {"--replay", dir.path() / "in.lcmlog", "--out", out});
    ASSERT_EQ(replay.exit_code, 0) << replay.err;
    expect_keys(json::parse(test::slurp(out / "result.json")),
                {"messages", "message_us", "wall_s", "realtime_factor"});
  }
}

TEST(Evaluate, KeysOfTrajectoriesAndRelations) {
  const test::TemporaryDir dir;
  const std::string path = dir.path() / "path.tum";
  std::ofstream(path) << "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n";
  std::ofstream(dir.path() / "path.relations") << "1 2 1 0 0 0 0 0\n";
  expect_keys(output_of("nodmap-evaluate", {"trajectory", path, path}),
              {"ate_rmse_m", "ate_max_m", "rot_rmse_deg", "drift_percent"});
  expect_keys(output_of("nodmap-evaluate", {"relations", path, dir.path() / "path.relations"}),
              {"n", "missing", "trans_mean_m", "trans_std_m", "trans_max_m", "rot_mean_deg",
               "rot_std_deg"});
}

TEST(Deputy, TakesItsConfigurationAlsoAsAnOption) {
  const auto result = run_program("nodmap-deputy", {"--config", "/nowhere.pmd"});
  EXPECT_NE(result.err.find("/nowhere.pmd"), std::string::npos) << result.err;
}

#ifdef NODMAP_BENCH_PROGRAMS
class Bench : public testing::Test {
 protected:
  void SetUp() override {
    const auto made = run_program("nodmap-bench-registration",
                                  {"generate", dir_.path(), "--pairs", "1", "--sweeps", "2"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }

  test::TemporaryDir dir_;
};

TEST_F(Bench, KeysOfRegistration) {
  const json pairs = output_of("nodmap-bench-registration", {"pairs", dir_.path() / "pairs"});
  ASSERT_TRUE(pairs.contains("pairs") && !pairs["pairs"].empty()) << pairs.dump(2);
  expect_keys(pairs["pairs"][0],
              {"name", "guess", "prep_ms", "align_ms", "iterations", "t_err_mm", "r_err_deg"});
  expect_keys(output_of("nodmap-bench-registration", {"sequence", dir_.path() / "seq"}),
              {"wall_s", "ate_rmse_m", "rot_rmse_deg", "odometry_ate_rmse_m"});
}

// That the files are identical is in the exit code, too.
TEST_F(Bench, KeysOfOctomapAndTheSameBytesAlsoDiscretized) {
  std::vector<std::string> arguments{dir_.path() / "seq", "--resolution", "0.05", "--max-range",
                                     "10"};
  for (const char* option : {"", "--discretize"}) {
    if (*option != '\0') {
      arguments.emplace_back(option);
    }
    const json result = output_of("nodmap-bench-octomap", arguments);
    expect_keys(result, {"stock_ms_per_scan", "ours_ms_per_scan", "ratio", "stock_mem_mb",
                         "ours_mem_mb", "bt_identical", "ot_identical"});
    EXPECT_TRUE(result["bt_identical"].get<bool>()) << option;
    EXPECT_TRUE(result["ot_identical"].get<bool>()) << option;
  }
}
#endif

}  // namespace fixed_names_test
}  // namespace nodmap
