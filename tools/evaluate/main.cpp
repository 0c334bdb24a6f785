// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/formats/ply.hpp"
#include "common/formats/tum.hpp"
#include "common/formats/user_error.hpp"
#include "common/node/log.hpp"
#include "common/node/option_checks.hpp"
#include "common/node/program.hpp"
#include "sim/world/world_name.hpp"
#include "tools/evaluate/cloud_error.hpp"
#include "tools/evaluate/corridor_error.hpp"
#include "tools/evaluate/relations.hpp"
#include "tools/evaluate/relocalisation.hpp"
#include "tools/evaluate/trajectory_error.hpp"

namespace {

namespace evaluate = nodmap::evaluate;
using nodmap::formats::UserError;
using nodmap::geometry::rad_to_deg;

using evaluate::RelocalisationPlan;

struct Arguments {
  std::string trajectory;
  std::string truth;
  bool align = false;
  double tolerance_s = 0.05;
  std::string cloud;
  std::string world;
  std::string unfiltered;
  std::vector<double> start;
  std::string map;
  std::string log;
  RelocalisationPlan plan = {};
  std::function<void()> work;  // the work of the chosen subcommand
};

void print_relations(const Arguments& arguments) {
  const auto relations = evaluate::read_relations(arguments.truth);
  if (relations.empty()) {
    throw UserError(arguments.truth + ": contains no relation");
  }
  const auto errors =
      evaluate::measure_relations(nodmap::formats::read_tum(arguments.trajectory), relations);
  if (errors.n == 0) {
    throw UserError(arguments.trajectory + ": does not contain both stamps of any of the " +
                    std::to_string(errors.missing) + " relations");
  }
  const nlohmann::ordered_json result = {{"n", errors.n},
                                         {"missing", errors.missing},
                                         {"trans_mean_m", errors.trans_mean_m},
                                         {"trans_std_m", errors.trans_std_m},
                                         {"trans_max_m", errors.trans_max_m},
                                         {"rot_mean_deg", rad_to_deg(errors.rot_mean_rad)},
                                         {"rot_std_deg", rad_to_deg(errors.rot_std_rad)}};
  std::cout << result.dump(2) << "\n";
}

struct Trajectories {
  nodmap::formats::Trajectory estimate;
  nodmap::formats::Trajectory truth;
  std::vector<evaluate::PosePair> pairs;  // not empty
};

nodmap::formats::Trajectory read_trajectory(const std::string& file) {
  nodmap::formats::Trajectory trajectory = nodmap::formats::read_tum(file);
  if (trajectory.empty()) {
    throw UserError(file + ": contains no pose");
  }
  return trajectory;
}

Trajectories read_trajectories(const Arguments& arguments) {
  Trajectories read{read_trajectory(arguments.trajectory), read_trajectory(arguments.truth), {}};
  read.pairs = evaluate::associate(read.estimate, read.truth,
                                   nodmap::time::from_seconds(arguments.tolerance_s));
  if (read.pairs.empty()) {
    throw UserError(arguments.trajectory + ": none of its " + std::to_string(read.estimate.size()) +
                    " poses has a true pose at its time");
  }
  return read;
}

void print_corridor(const Arguments& arguments) {
  const auto pairs = read_trajectories(arguments).pairs;
  const auto errors = evaluate::measure_corridor(pairs);
  if (!errors) {
    throw UserError(arguments.truth + ": is too short to be the path through a corridor");
  }
  const nlohmann::ordered_json result = {
      {"n", pairs.size()},
      {"length_m", errors->length_m},
      {"length_error_m", errors->length_error_m},
      {"length_error_percent", 100.0 * errors->length_error_m / errors->length_m},
      {"bow_m", errors->bow_m},
      {"heading_error_deg", rad_to_deg(errors->heading_error_rad)}};
  std::cout << result.dump(2) << "\n";
}

void print_trajectory(const Arguments& arguments) {
  const auto [estimate, truth, pairs] = read_trajectories(arguments);
  const auto errors = evaluate::measure_trajectory(
      pairs, arguments.align ? evaluate::Alignment::kMinSquares : evaluate::Alignment::kFirstPose);
  nlohmann::ordered_json result = {{"n", errors.n},
                                   {"without_truth", estimate.size() - errors.n},
                                   {"longest_gap_s", evaluate::longest_gap_s(estimate, truth)},
                                   {"ate_rmse_m", errors.ate_rmse_m},
                                   {"ate_max_m", errors.ate_max_m},
                                   {"rot_rmse_deg", rad_to_deg(errors.rot_rmse_rad)},
                                   {"end_error_m", errors.end_error_m},
                                   {"end_error_deg", rad_to_deg(errors.end_rot_rad)},
                                   {"drift_percent", nullptr}};
  if (errors.drift_percent) {
    result["drift_percent"] = *errors.drift_percent;
  }
  std::cout << result.dump(2) << "\n";
}

void print_cloud(const Arguments& arguments) {
  const nodmap::sim::World world = nodmap::sim::make_world(arguments.world);
  nodmap::geometry::SE2 T_world_map = world.T_world_start;
  if (!arguments.start.empty()) {
    T_world_map = {arguments.start[0], arguments.start[1],
                   nodmap::geometry::deg_to_rad(arguments.start[2])};
  }
  const auto measure = [&](const std::string& cloud) {
    return evaluate::measure_cloud(nodmap::formats::read_ply(cloud),
                                   nodmap::geometry::to_se3(T_world_map), world);
  };
  const auto errors = measure(arguments.cloud);
  if (errors.n == 0) {
    throw UserError(arguments.cloud + ": contains no points");
  }
  nlohmann::ordered_json result = {{"n", errors.n},
                                   {"rms_m", errors.rms_m},
                                   {"p95_m", errors.p95_m},
                                   {"outlier_share", errors.outlier_share},
                                   {"completeness", errors.completeness}};
  if (!arguments.unfiltered.empty()) {
    const auto unfiltered = measure(arguments.unfiltered);
    if (unfiltered.n < errors.n) {
      throw UserError(arguments.unfiltered + ": has fewer points than " + arguments.cloud +
                      ", so that is not what was left of it");
    }
    const auto removal = evaluate::measure_removal(unfiltered, errors);
    result["static_kept"] = removal.static_kept;
    result["dynamic_removed"] = removal.dynamic_removed;
    result["associated_accuracy"] = removal.associated;
  }
  std::cout << result.dump(2) << "\n";
}

void print_relocalisations(const Arguments& arguments) {
  const auto result = evaluate::measure_relocalisation(
      arguments.map, arguments.log, read_trajectory(arguments.truth), arguments.plan);
  if (result.n == 0) {
    throw UserError(arguments.log + ": contains no scan with a known true pose");
  }
  const nlohmann::ordered_json json = {{"n", result.n},           {"right", result.right},
                                       {"wrong", result.wrong},   {"said_lost", result.said_lost},
                                       {"ms_p50", result.ms_p50}, {"ms_max", result.ms_max}};
  std::cout << json.dump(2) << "\n";
}

CLI::App* add_against_truth(CLI::App& app, Arguments& arguments, const char* name,
                            const char* summary) {
  CLI::App* command = app.add_subcommand(name, summary);
  command->add_option("ESTIMATE", arguments.trajectory, "Estimate (.tum)")->required();
  command->add_option("TRUTH", arguments.truth, "Truth (.tum)")->required();
  command
      ->add_option("--tolerance-s", arguments.tolerance_s,
                   "Largest time difference to the nearest true pose, seconds")
      ->check(nodmap::node::at_least_zero())
      ->capture_default_str();
  return command;
}

void add_commands(CLI::App& app, Arguments& arguments) {
  CLI::App* relations =
      app.add_subcommand("relations", "Error of relative poses (Kuemmerle et al. 2009), as JSON");
  relations->add_option("TRAJECTORY", arguments.trajectory, "Estimate (.tum)")->required();
  relations->add_option("RELATIONS", arguments.truth, "Known relations (.relations)")->required();
  relations->callback([&arguments] { arguments.work = [&] { print_relations(arguments); }; });

  CLI::App* trajectory =
      add_against_truth(app, arguments, "trajectory", "Error against a true trajectory, as JSON");
  trajectory->add_flag("--align", arguments.align,
                       "Align all positions by least squares instead of the first pose");
  trajectory->callback([&arguments] { arguments.work = [&] { print_trajectory(arguments); }; });

  CLI::App* corridor = add_against_truth(
      app, arguments, "corridor",
      "Errors in length, bow and heading of a corridor's map, from the trajectory, as JSON");
  corridor->callback([&arguments] { arguments.work = [&] { print_corridor(arguments); }; });

  CLI::App* cloud = app.add_subcommand(
      "cloud", "Distance of a cloud's points from the surfaces of a simulated world, as JSON");
  cloud->add_option("CLOUD", arguments.cloud, "Registered points (.ply)")->required();
  cloud
      ->add_option("WORLD", arguments.world,
                   "The world: a file (.yaml), or a name as for nodmap-trial --world")
      ->required();
  cloud
      ->add_option("--start", arguments.start,
                   "X Y YAW_DEG: the map's origin in the world; default: the robot's start")
      ->expected(3);
  cloud->add_option(
      "--unfiltered", arguments.unfiltered,
      "The same cloud with its moving points: also reports what was kept and removed");
  cloud->callback([&arguments] { arguments.work = [&] { print_cloud(arguments); }; });

  CLI::App* relocalise =
      app.add_subcommand("relocalise", "How often a lost robot finds its pose in a map, as JSON");
  relocalise->add_option("MAP", arguments.map, "map.yaml, or the folder with it")->required();
  relocalise->add_option("LOG", arguments.log, "LCM event log with SCAN and ODOMETRY")->required();
  relocalise->add_option("TRUTH", arguments.truth, "True poses in the map (.tum)")->required();
  relocalise->add_option("--scans", arguments.plan.num_scans, "Successive level scans in a group")
      ->check(nodmap::node::in_range(1, 1000))
      ->capture_default_str();
  relocalise
      ->add_option("--every", arguments.plan.every,
                   "Use every K-th group; default: about 200 groups in all")
      ->check(nodmap::node::above_zero());
  relocalise->callback(
      [&arguments] { arguments.work = [&] { print_relocalisations(arguments); }; });
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  return nodmap::node::run_program(argc, argv,
                                   {.name = "nodmap-evaluate",
                                    .summary = "Compares results with ground truth.",
                                    .is_killed_by_signals = true,
                                    .add_options =
                                        [&arguments](CLI::App& app) {
                                          app.require_subcommand(1);
                                          add_commands(app, arguments);
                                        },
                                    .run =
                                        [&arguments](const std::string& /*lcm_url*/) {
                                          arguments.work();
                                          return 0;
                                        }});
}
