// SPDX-License-Identifier: BSD-3-Clause
// The quality of the maps of a trial, compared with the simulated world: short versions of the
// trials in bench/trials.py and scripts/figures.
#include <gtest/gtest.h>

#include <algorithm>
#include <future>
#include <limits>
#include <vector>

#include "common/bus/event_log.hpp"
#include "common/formats/ply.hpp"
#include "common/geometry/pose_history.hpp"
#include "common/node/messages.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"
#include "sim/world/world_file.hpp"
#include "tests/support/data_dir.hpp"
#include "tools/evaluate/cloud_error.hpp"
#include "tools/trial/metrics.hpp"
#include "tools/trial/record.hpp"
#include "tools/trial/results.hpp"
#include "tools/trial/trial.hpp"

namespace nodmap::trial {
namespace mapping_test {

// Measured: 0.9884 and 0.889; 1.25 times as many wrong and missing voxels are permitted.
constexpr double kMinPrecision = 0.9855;
constexpr double kMinRecall = 0.861;

constexpr time::Duration kForever = time::kLimit;

TrialSetup setup(const std::string& world, std::uint64_t seed, double duration_s) {
  TrialSetup setup;
  setup.world = sim::load_world(std::string(NODMAP_WORLDS) + "/" + world + ".yaml");
  setup.seed = seed;
  setup.duration = time::from_seconds(duration_s);
  return setup;
}

TrialOutcome run(const TrialSetup& setup, const std::filesystem::path& dir) {
  Trial trial(setup, dir);
  while (trial.step()) {
  }
  return trial.finish();
}

std::vector<scan::Scan> read_scans(const std::filesystem::path& dir) {
  bus::LogReader reader(dir / "trial.lcmlog");
  std::vector<scan::Scan> scans;
  nodmap::scan_t message{};
  while (const bus::LogEvent* event = reader.next()) {
    scan::Scan scan;
    if (event->channel == "SCAN" && bus::decode_into(message, event->data) &&
        node::read_scan(message, scan)) {
      scans.push_back(std::move(scan));
    }
  }
  return scans;
}

geometry::PoseHistory history_of(const formats::Trajectory& trajectory) {
  geometry::PoseHistory history(kForever);
  for (const formats::StampedPose& pose : trajectory) {
    history.add(pose.stamp, pose.pose);
  }
  return history;
}

// At full speed, without the local map, which limits the speed by the floor seen ahead.
void drive_as_in_the_paper(TrialSetup& trial) {
  trial.params.set_assignment("navigator.local_map.use_local_map=false");
  trial.params.set_assignment("navigator.planner.use_planner=false");
}

class MappingTest : public ::testing::Test {
 protected:
  test::TemporaryDir dir_;

  [[nodiscard]] std::filesystem::path folder(const std::string& name) const {
    std::filesystem::create_directory(dir_.path() / name);
    return dir_.path() / name;
  }
};

// R39: "the resulting map does not rank behind" one of a laser that is mounted level. The same
// drives, mapped by the same program from what the laser would have measured if held level. The
// mean of sixteen, because a single ratio is mostly chance: an earlier version's were between 0.3
// and 4, and that of eight drives was 1.21 or 0.97. The ratio of the means is 1.089 (4.47 to 4.10
// mm); R39 permits 1.2.
TEST_F(MappingTest, R39_NoddingCostsNoQualityOfThe2dMap) {
  constexpr int kNumSeeds = 16;
  struct Errors {
    double nodding_m = 0.0;
    double level_m = 0.0;
    double least_distance_m = std::numeric_limits<double>::infinity();
  };
  const auto drive = [this](std::uint64_t seed, Errors& sums) {
    TrialSetup trial = setup("office", seed, 25.0);
    trial.without = {"slam6d"};
    trial.level_laser = true;
    trial.params.set_assignment("sim.odometry_scale_bias=0.03");
    const auto dir = folder(std::to_string(seed));
    const TrialOutcome outcome = run(trial, dir);
    const auto result = summarise(trial, outcome, dir);
    sums.nodding_m += result["slam2d"]["ate_rmse_m"].get<double>();
    sums.level_m += result["slam2d_level"]["ate_rmse_m"].get<double>();
    sums.least_distance_m =
        std::min(sums.least_distance_m, drive_metrics(outcome.record).distance_m);
  };
  // On two threads, because after a change in a SLAM hardly any other test takes as long.
  const auto drive_every_other = [&drive](std::uint64_t first) {
    Errors sums;
    for (std::uint64_t seed = first; seed < first + kNumSeeds; seed += 2) {
      drive(seed, sums);
    }
    return sums;
  };
  auto evens = std::async(std::launch::async, drive_every_other, 1002);
  const Errors odd = drive_every_other(1001);
  const Errors even = evens.get();
  const double nodding_m = (odd.nodding_m + even.nodding_m) / kNumSeeds;
  const double level_m = (odd.level_m + even.level_m) / kNumSeeds;
  RecordProperty("nodding_mm", std::to_string(1000.0 * nodding_m));
  RecordProperty("level_mm", std::to_string(1000.0 * level_m));
  EXPECT_GT(std::min(odd.least_distance_m, even.least_distance_m), 5.0);
  EXPECT_GT(level_m, 0.0);
  EXPECT_LE(nodding_m, 1.2 * level_m);
}

// R46: the OctoMap of a drive against the true surfaces, to one voxel.
TEST_F(MappingTest, R46_OccupiedVoxelsAreAtTrueSurfaces) {
  TrialSetup trial = setup("cellar", 1002, 15.0);
  trial.without = {"slam2d"};
  const TrialOutcome outcome = run(trial, dir_.path());
  const auto occupancy = summarise(trial, outcome, dir_.path())["occupancy"];
  RecordProperty("precision", occupancy["precision"].dump());
  RecordProperty("recall", occupancy["recall"].dump());
  EXPECT_GT(occupancy["num_occupied"], 1000);
  EXPECT_GE(occupancy["precision"], kMinPrecision);
  EXPECT_GE(occupancy["recall"], kMinRecall);
}

// R42, Fig. 8: 50 scans at full speed, about a metre, deskewed with odometry; the cloud is placed
// at the robot's true pose.
TEST_F(MappingTest, R42_FiftyScansOnTheMoveLieOnTheSurfaces) {
  TrialSetup trial = setup("corridor30", 1002, 14.0);
  trial.without = {"slam2d", "slam6d"};
  drive_as_in_the_paper(trial);
  const TrialOutcome outcome = run(trial, dir_.path());
  const auto odometry = history_of(outcome.record.odometry);
  const auto truth = history_of(true_trajectory(outcome.record, false));
  const auto fastest =
      std::ranges::max_element(outcome.record.truth, {}, &TruthSample::forward_mps);
  const std::vector<scan::Scan> scans = read_scans(dir_.path());
  const auto first =
      std::ranges::lower_bound(scans, stamp_at(fastest->instant), {}, &scan::Scan::stamp);
  ASSERT_GE(scans.end() - first, 50);
  const auto cloud =
      slam6d::deskew({first, 50}, [&odometry](auto stamp) { return odometry.at(stamp); },
                     {.min_m = 0.5, .max_m = 30.0});
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->scans_used, 50U);
  EXPECT_NEAR(cloud->motion().translation().norm(), 1.0, 0.1);  // 0.67 s at about 1.5 m/s
  const auto errors =
      evaluate::measure_cloud(cloud->points, truth.at(cloud->stamp).value(), trial.world);
  RecordProperty("rms_mm", std::to_string(1e3 * errors.rms_m));
  EXPECT_GT(errors.n, 5000U);
  EXPECT_LE(errors.rms_m, 0.0232);  // 0.0185 measured; R42 permits 0.03
}

double model_rms_m(const TrialSetup& trial, const std::filesystem::path& dir) {
  (void)run(trial, dir);
  const auto points = formats::read_ply(dir / "slam6d" / "cloud.ply");
  return evaluate::measure_cloud(points, geometry::to_se3(trial.world.T_world_start), trial.world)
      .rms_m;
}

// R45, Fig. 9: the model from clouds taken while driving is "slightly more distorted" than one
// taken while stationary.
TEST_F(MappingTest, R45_OnTheMoveTheModelIsOnlySlightlyMoreDistorted) {
  TrialSetup moving = setup("cellar", 1002, 15.0);
  moving.without = {"slam2d"};
  TrialSetup standing = setup("cellar", 1002, 8.0);
  standing.without = {"slam2d", "navigator"};
  const double moving_m = model_rms_m(moving, folder("moving"));
  const double standing_m = model_rms_m(standing, folder("standing"));
  RecordProperty("moving_mm", std::to_string(1e3 * moving_m));
  RecordProperty("standing_mm", std::to_string(1e3 * standing_m));
  EXPECT_GT(standing_m, 0.005);            // the sensor's noise is 10 mm
  EXPECT_LE(moving_m, 1.09 * standing_m);  // 0.87 measured; R45 permits 1.5
}

// The laser sits beside the pitch axis, and its driver knows where.
TEST_F(MappingTest, AMirrorOffThePitchAxisDoesNotDistortTheModel) {
  TrialSetup trial = setup("cellar", 1002, 15.0);
  trial.without = {"slam2d"};
  trial.params.set_assignment("sim.mirror_forward_m=0.03");
  trial.params.set_assignment("sim.mirror_up_m=0.03");
  const double unknown_m = model_rms_m(trial, folder("unknown"));
  trial.params.set_assignment("laser3d.mirror.forward_m=0.03");
  trial.params.set_assignment("laser3d.mirror.up_m=0.03");
  const auto dir = folder("known");
  const double known_m = model_rms_m(trial, dir);
  RecordProperty("unknown_mm", std::to_string(1e3 * unknown_m));
  RecordProperty("known_mm", std::to_string(1e3 * known_m));
  EXPECT_LE(known_m, 0.013);     // 0.0104 measured; 0.0113 with the mirror on the axis
  EXPECT_GT(unknown_m, 0.0176);  // 0.0220: 3 cm do matter
}

}  // namespace mapping_test
}  // namespace nodmap::trial
