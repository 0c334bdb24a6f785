// SPDX-License-Identifier: BSD-3-Clause
// Measures the core of the 6D registration on clouds with known true poses. Prints JSON.
//   nodmap-bench-registration pairs DIR
//   nodmap-bench-registration sequence DIR
//   nodmap-bench-registration generate DIR --seed N
// `pairs` registers each NAME_src.bin on NAME_tgt.bin from the guesses NAME_init.txt (hard) and
// NAME_inite.txt (easy). `sequence` tracks the clouds NNN.bin with the odometry NNN_odo.txt. The
// true poses are in *_gt.txt. `generate` writes such folders (DIR/pairs, DIR/seq) from a simulated
// floor.
#include "modules/slam6d/registration/registration.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/registration_scene.hpp"
#include "bench/timing.hpp"
#include "common/geometry/angle.hpp"
#include "common/params/params.hpp"
#include "modules/slam6d/registration/heading_search.hpp"
#include "modules/slam6d/slam6d.hpp"
#include "tests/support/cloud_file.hpp"

namespace {

namespace fs = std::filesystem;
namespace geometry = nodmap::geometry;
using namespace nodmap::slam6d;
using geometry::SE3;
using nlohmann::ordered_json;
using nodmap::bench::process_cpu_ms;
using nodmap::test::read_cloud_file;
using nodmap::test::read_matrix_file;

constexpr int kRepeats = 5;  // registrations of each pair; the median time is reported

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values.empty() ? 0.0 : values[values.size() / 2];
}

std::vector<std::string> names_ending_in(const fs::path& dir, const std::string& ending) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(dir)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(ending)) {
      names.push_back(name.substr(0, name.size() - ending.size()));
    }
  }
  if (names.empty()) {
    throw std::runtime_error(dir.string() + ": holds no *" + ending);
  }
  std::ranges::sort(names);
  return names;
}

// ---- pairs ----------------------------------------------------------------------------------

struct PairResult {
  double prep_ms = 0.0;
  double align_ms = 0.0;
  double t_err_mm = 0.0;
  double r_err_deg = 0.0;
};

// The prior of a guess that may be wrong by 0.2 m and 5 degrees.
PosePrior guess_prior(const SE3& guess) {
  PosePrior prior{guess, Matrix6d::Zero()};
  prior.covariance.diagonal() << Eigen::Vector3d::Constant(0.04),
      Eigen::Vector3d::Constant(std::pow(geometry::deg_to_rad(5.0), 2));
  return prior;
}

PairResult run_pair(const std::vector<Eigen::Vector3f>& target,
                    const std::vector<Eigen::Vector3f>& source, const PosePrior& prior,
                    const SE3& truth, const Slam6dParams& params, Registration& registration) {
  const Eigen::Vector3f p_sensor = Eigen::Vector3f::Zero();
  std::vector<double> prep_ms;
  std::vector<double> align_ms;
  for (int i = 0; i < kRepeats; ++i) {
    const double begin = process_cpu_ms();
    const VoxelMap map = VoxelMap::from_points(target, p_sensor, params.voxels);
    VoxelMap sweep = VoxelMap::from_points(source, p_sensor, params.voxels);
    const double middle = process_cpu_ms();
    registration = register_sweep(sweep, map, prior, params.registration);
    prep_ms.push_back(middle - begin);
    align_ms.push_back(process_cpu_ms() - middle);
  }
  const SE3 error = truth.inverse() * registration.T_map_base;
  return {median(prep_ms), median(align_ms), 1e3 * error.translation().norm(),
          geometry::rad_to_deg(geometry::rotation_angle(error))};
}

ordered_json summary_of(const std::vector<PairResult>& results) {
  const auto values = [&](auto member) {
    std::vector<double> all;
    for (const PairResult& result : results) {
      all.push_back(result.*member);
    }
    return all;
  };
  const auto right = std::ranges::count_if(results, [](const PairResult& result) {
    return result.t_err_mm < 20.0 && result.r_err_deg < 0.5;
  });
  return {{"n", results.size()},
          {"right", right},
          {"prep_ms_median", median(values(&PairResult::prep_ms))},
          {"align_ms_median", median(values(&PairResult::align_ms))},
          {"t_err_mm_median", median(values(&PairResult::t_err_mm))},
          {"t_err_mm_max", std::ranges::max(values(&PairResult::t_err_mm))},
          {"r_err_deg_median", median(values(&PairResult::r_err_deg))},
          {"r_err_deg_max", std::ranges::max(values(&PairResult::r_err_deg))}};
}

ordered_json run_pairs(const fs::path& dir, const Slam6dParams& params) {
  ordered_json list = ordered_json::array();
  std::map<std::string, std::vector<PairResult>> by_size;
  for (const std::string& name : names_ending_in(dir, "_src.bin")) {
    const auto source = read_cloud_file(dir / (name + "_src.bin"));
    const auto target = read_cloud_file(dir / (name + "_tgt.bin"));
    const SE3 truth = read_matrix_file(dir / (name + "_gt.txt"));
    const std::string size = std::to_string((source.size() + 500) / 1000) + "k";
    for (const auto& [guess, file] : {std::pair("easy", "_inite.txt"), {"hard", "_init.txt"}}) {
      Registration registration;
      const PairResult result =
          run_pair(target, source, guess_prior(read_matrix_file(dir / (name + file))), truth,
                   params, registration);
      by_size[size + " " + guess].push_back(result);
      list.push_back(
          {{"name", name},
           {"guess", guess},
           {"prep_ms", result.prep_ms},
           {"align_ms", result.align_ms},
           {"iterations", registration.iterations},
           {"t_err_mm", result.t_err_mm},
           {"r_err_deg", result.r_err_deg},
           {"inlier_ratio", registration.inlier_ratio},
           {"residual_rms_mm", 1e3 * registration.residual_rms_m},
           {"sigma_mm", 1e3 * std::sqrt(registration.covariance.topLeftCorner<3, 3>().trace())}});
    }
  }
  ordered_json summary;
  for (const auto& [size, results] : by_size) {
    summary[size] = summary_of(results);
  }
  return {{"pairs", list}, {"summary", summary}};
}

// ---- sequence -------------------------------------------------------------------------------

struct TrajectoryError {
  double ate_rmse_m = 0.0;
  double rot_rmse_deg = 0.0;
};

// Absolute trajectory error after aligning the first poses.
TrajectoryError trajectory_error(const std::vector<SE3>& truth, const std::vector<SE3>& estimate) {
  double sq_m2 = 0.0;
  double sq_rad2 = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const SE3 error =
        (truth[0].inverse() * truth[k]).inverse() * estimate[0].inverse() * estimate[k];
    sq_m2 += error.translation().squaredNorm();
    sq_rad2 += std::pow(geometry::rotation_angle(error), 2);
  }
  const auto n = static_cast<double>(truth.size());
  return {std::sqrt(sq_m2 / n), geometry::rad_to_deg(std::sqrt(sq_rad2 / n))};
}

ordered_json run_sequence(const fs::path& dir, const Slam6dParams& params) {
  std::vector<SweepCloud> clouds;
  std::vector<SE3> truth;
  std::vector<SE3> odometry;
  for (const std::string& name : names_ending_in(dir, "_gt.txt")) {
    SweepCloud cloud;
    cloud.points = read_cloud_file(dir / (name + ".bin"));
    cloud.lines.push_back({Eigen::Vector3f::Zero(), cloud.points.size()});
    cloud.scans_used = 120;
    cloud.T_odom_base = read_matrix_file(dir / (name + "_odo.txt"));
    odometry.push_back(cloud.T_odom_base);
    truth.push_back(read_matrix_file(dir / (name + "_gt.txt")));
    clouds.push_back(std::move(cloud));
  }
  const auto begin = std::chrono::steady_clock::now();
  const double begin_ms = process_cpu_ms();
  Slam6d slam(params);
  for (SweepCloud& cloud : clouds) {
    slam.add_cloud(std::move(cloud));
  }
  slam.polish();
  const std::vector<SE3> trajectory = slam.trajectory();
  const double end_ms = process_cpu_ms();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  const TrajectoryError error = trajectory_error(truth, trajectory);
  const Metrics metrics = slam.metrics();
  return {{"sweeps", truth.size()},
          {"wall_s", wall.count()},
          {"cpu_s", 1e-3 * (end_ms - begin_ms)},
          {"ate_rmse_m", error.ate_rmse_m},
          {"rot_rmse_deg", error.rot_rmse_deg},
          {"odometry_ate_rmse_m", trajectory_error(truth, odometry).ate_rmse_m},
          {"tracked", metrics.sweeps_tracked},
          {"degraded", metrics.sweeps_degraded},
          {"lost", metrics.sweeps_lost},
          {"map_memory_mb", 1e-6 * static_cast<double>(metrics.map_memory_bytes)}};
}

// ---- generate -------------------------------------------------------------------------------

void write_cloud_file(const fs::path& file, const std::vector<Eigen::Vector3f>& points) {
  std::ofstream out(file, std::ios::binary);
  const std::uint64_t count = points.size();
  out.write(reinterpret_cast<const char*>(&count), sizeof count);
  for (const Eigen::Vector3f& p : points) {
    out.write(reinterpret_cast<const char*>(p.data()), 3 * sizeof(float));
  }
}

void write_matrix_file(const fs::path& file, const SE3& pose) {
  std::ofstream(file) << std::setprecision(12) << pose.matrix() << "\n";
}

std::string number(std::size_t k) {
  const std::string digits = std::to_string(k);
  return std::string(3 - std::min<std::size_t>(3, digits.size()), '0') + digits;
}

// Writes the clouds of two poses, 0.5 m and up to 12 degrees apart, and two guesses: one with an
// error of about 5 cm and 1.3 degrees, one of about 0.2 m and 5 degrees.
void generate_pair(const fs::path& base, const nodmap::sim::RayCaster& world,
                   const SE3& T_world_target, const nodmap::bench::SweepShape& shape,
                   std::mt19937_64& random) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  SE3 truth = SE3::Identity();
  const double direction_rad = geometry::kPi * any(random);
  truth.translation() << 0.5 * std::cos(direction_rad), 0.5 * std::sin(direction_rad),
      0.05 * any(random);
  truth.linear() =
      Eigen::AngleAxisd(geometry::deg_to_rad(12.0) * any(random),
                        Eigen::Vector3d(0.1 * any(random), 0.1 * any(random), 1.0).normalized())
          .toRotationMatrix();
  write_cloud_file(base.string() + "_tgt.bin",
                   nodmap::bench::nodding_sweep(world, T_world_target, shape, random));
  write_cloud_file(base.string() + "_src.bin",
                   nodmap::bench::nodding_sweep(world, T_world_target * truth, shape, random));
  write_matrix_file(base.string() + "_gt.txt", truth);
  // The errors of the three directions together are larger by a factor of sqrt(3).
  write_matrix_file(base.string() + "_inite.txt",
                    nodmap::bench::disturbed(truth, 0.029, geometry::deg_to_rad(0.75), random));
  write_matrix_file(base.string() + "_init.txt",
                    nodmap::bench::disturbed(truth, 0.115, geometry::deg_to_rad(2.9), random));
}

void generate_pairs(const fs::path& dir, const nodmap::sim::RayCaster& world, int num_pairs,
                    std::mt19937_64& random) {
  const auto poses = nodmap::bench::drive_on_floor(static_cast<std::size_t>(5 * num_pairs), random);
  for (int k = 0; k < num_pairs; ++k) {
    const SE3& T_world_target = poses[static_cast<std::size_t>(5 * k)];
    generate_pair(dir / ("pair_10k_" + std::to_string(k)), world, T_world_target,
                  {.lines = 100, .beams = 101}, random);
    if (k % 2 == 0) {
      generate_pair(dir / ("pair_100k_" + std::to_string(k)), world, T_world_target,
                    {.lines = 280, .beams = 361}, random);
    }
  }
}

void generate_sequence(const fs::path& dir, const nodmap::sim::RayCaster& world, int num_sweeps,
                       std::mt19937_64& random) {
  const auto poses = nodmap::bench::drive_on_floor(static_cast<std::size_t>(num_sweeps), random);
  SE3 odometry = poses.front();
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (k > 0) {
      odometry = odometry * nodmap::bench::disturbed(poses[k - 1].inverse() * poses[k], 0.025,
                                                     geometry::deg_to_rad(0.6), random);
    }
    write_cloud_file(dir / (number(k) + ".bin"),
                     nodmap::bench::nodding_sweep(world, poses[k], {}, random));
    write_matrix_file(dir / (number(k) + "_gt.txt"), poses[k]);
    write_matrix_file(dir / (number(k) + "_odo.txt"), odometry);
  }
}

void generate(const fs::path& dir, std::uint64_t seed, int num_pairs, int num_sweeps) {
  std::mt19937_64 random(seed);
  const nodmap::sim::World floor = nodmap::bench::furnished_floor(seed);
  const nodmap::sim::RayCaster world(floor);
  fs::create_directories(dir / "pairs");
  fs::create_directories(dir / "seq");
  generate_pairs(dir / "pairs", world, num_pairs, random);
  generate_sequence(dir / "seq", world, num_sweeps, random);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    CLI::App app("Measures the core of the 6D registration on clouds whose true poses are known.");
    std::string dir;
    std::uint64_t seed = 1;
    int num_pairs = 10;
    int num_sweeps = 60;
    auto* pairs = app.add_subcommand("pairs", "registers pairs of clouds");
    pairs->add_option("DIR", dir)->required()->check(CLI::ExistingDirectory);
    auto* sequence = app.add_subcommand("sequence", "tracks a sequence of clouds");
    sequence->add_option("DIR", dir)->required()->check(CLI::ExistingDirectory);
    auto* make = app.add_subcommand(
        "generate", "writes pairs and a sequence of clouds from a simulated furnished floor");
    make->add_option("DIR", dir)->required();
    make->add_option("--seed", seed)->capture_default_str();
    make->add_option("--pairs", num_pairs)->capture_default_str()->check(CLI::Range(0, 1000));
    make->add_option("--sweeps", num_sweeps)->capture_default_str()->check(CLI::Range(1, 999));
    std::vector<std::string> assignments;
    for (auto* command : {pairs, sequence}) {
      command->add_option("--set", assignments, "a parameter of nodmap-slam6d, key=value");
    }
    app.require_subcommand(1);
    CLI11_PARSE(app, argc, argv);
    Slam6dParams params;
    nodmap::params::Table table(params);
    for (const std::string& assignment : assignments) {
      table.set_assignment(assignment);
    }
    if (*make) {
      generate(dir, seed, num_pairs, num_sweeps);
    } else {
      std::cout << (*pairs ? run_pairs(dir, params) : run_sequence(dir, params)).dump(2) << "\n";
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "nodmap-bench-registration: %s\n", error.what());
    return 1;
  }
  return 0;
}
