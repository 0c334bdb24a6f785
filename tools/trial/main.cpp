// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "common/node/log.hpp"
#include "common/node/option_checks.hpp"
#include "common/node/program.hpp"
#include "common/node/progress.hpp"
#include "common/node/results.hpp"
#include "common/params/params.hpp"
#include "sim/world/scenarios/scenarios.hpp"
#include "sim/world/world_name.hpp"
#include "tools/trial/appearing_obstacle.hpp"
#include "tools/trial/command.hpp"
#include "tools/trial/metrics.hpp"
#include "tools/trial/results.hpp"
#include "tools/trial/trial.hpp"

namespace nodmap::trial {
namespace {

constexpr const char* kName = "nodmap-trial";

struct Arguments {
  std::string world;
  std::string out;
  std::uint64_t seed = 0;
  std::optional<double> duration_s;
  std::string robot = "kurt3d";
  std::string pitch;
  std::vector<std::string> assignments;
  std::vector<std::string> faults;
  std::vector<std::string> kills;
  std::vector<std::string> without;
  std::string localise;
  std::string map_in;
  std::optional<double> appear_s;
  bool explore = false;
  bool level_laser = false;
  bool no_actors = false;
  bool dump_params = false;
};

// The given duration; otherwise enough for the world's time limit if the robot starts late.
double duration_s(const Arguments& arguments, const sim::World& world) {
  constexpr double kUntilMotionS = 30.0;
  constexpr double kUsualS = 60.0;
  return arguments.duration_s.value_or(
      world.task.time_limit_s ? *world.task.time_limit_s + kUntilMotionS : kUsualS);
}

void add_options(CLI::App& app, Arguments& arguments) {
  app.add_option("--world", arguments.world,
                 "World file, SCENARIO:SEED for a generated one, barn:FILE:INDEX, or "
                 "pedestrians:FILE:FRAMES_PER_SECOND:SEED; scenarios: " +
                     sim::scenario_names());
  app.add_option("--seed", arguments.seed, "Seed of the simulated noise")->capture_default_str();
  app.add_option(
         "--duration", arguments.duration_s,
         "Seconds of simulated time from the first scan; default 60, or the world's time limit")
      ->check(node::in_range(0.1, 86400.0));
  app.add_option("--out", arguments.out, "Folder for the results; created, never overwritten");
  app.add_option("--robot", arguments.robot, "kurt3d, or jackal: the robot of the BARN challenge")
      ->check(CLI::IsMember({"kurt3d", "jackal"}));
  app.add_option("--pitch", arguments.pitch, "Same as --set pitch_controller.mode=...")
      ->check(CLI::IsMember({"fixed", "nodding"}));
  app.add_option("--set", arguments.assignments, "A parameter: process.key=value; repeatable")
      ->allow_extra_args(false);
  app.add_option("--fault", arguments.faults,
                 "A fault, PART:KIND@T+D[=AMOUNT], such as laser:unplug@10+2: T s after power-on, "
                 "for D s; repeatable")
      ->allow_extra_args(false);
  app.add_option("--kill", arguments.kills,
                 "PROCESS@T+D: kill -9 at T s after power-on, restart D s later; repeatable")
      ->allow_extra_args(false);
  app.add_option("--appear", arguments.appear_s,
                 "Let one obstacle appear at the far end of the robot's stopping zone, after this "
                 "many seconds")
      ->check(node::at_least_zero());
  app.add_flag(
      "--explore", arguments.explore,
      "Also run the explorer, without the world's goals; the trial ends when everything has been "
      "seen and the robot is home");
  app.add_flag("--level-laser", arguments.level_laser,
               "Also run 2D SLAM on the scans that the laser would measure if held level");
  app.add_option("--without", arguments.without, "Omit this process; repeatable")
      ->allow_extra_args(false);
  auto* localise = app.add_option(
      "--localise", arguments.localise,
      "Localise 2D SLAM in a map that an earlier trial has saved: its folder slam2d");
  app.add_option("--map-in", arguments.map_in, "Let 2D SLAM extend such a map")->excludes(localise);
  app.add_flag_callback(
      "--no-slam6d", [&arguments] { arguments.without.emplace_back("slam6d"); },
      "Same as --without slam6d");
  app.add_flag("--no-actors", arguments.no_actors, "Omit the world's actors");
  app.add_flag("--dump-params", arguments.dump_params, "Print the effective parameters and exit");
}

// Throws if options contradict each other: the trial would not be the one that was asked for.
void check_options(const Arguments& arguments, const TrialSetup& setup) {
  for (const char* process : {"explorer", "navigator", "slam2d"}) {
    if (setup.explores && setup.without.contains(process)) {
      throw node::UsageError(std::string("--explore: needs the process ") + process);
    }
  }
  if (setup.without.contains("slam2d") && !(arguments.localise + arguments.map_in).empty()) {
    throw node::UsageError(std::string(arguments.localise.empty() ? "--map-in" : "--localise") +
                           ": needs the process slam2d");
  }
  if (!arguments.pitch.empty() &&
      std::ranges::any_of(arguments.assignments, [](const std::string& assignment) {
        return assignment.starts_with("pitch_controller.mode=");
      })) {
    throw node::UsageError("--pitch: --set pitch_controller.mode is given, too");
  }
  if (setup.robot != Robot::kJackal) {
    return;
  }
  if (setup.params.pitch_controller.mode == pitch_controller::Mode::kNodding) {
    throw node::UsageError("--robot jackal: its laser is level and cannot nod");
  }
  if (std::ranges::any_of(setup.faults,
                          [](const sim::Fault& fault) { return fault.part != sim::Part::kBase; })) {
    throw node::UsageError("--robot jackal: only its base can have faults");
  }
}

TrialSetup make_setup(const Arguments& arguments) {
  TrialSetup setup;
  setup.robot = arguments.robot == "jackal" ? Robot::kJackal : Robot::kKurt3d;
  set_robot(setup.robot, setup.params);
  for (const std::string& assignment : arguments.assignments) {
    setup.params.set_assignment(assignment);
  }
  if (!arguments.pitch.empty()) {
    setup.params.set_assignment("pitch_controller.mode=" + arguments.pitch);
  }
  for (const std::string& fault : arguments.faults) {
    setup.faults.push_back(sim::parse_fault(fault));
  }
  for (const std::string& kill : arguments.kills) {
    setup.kills.push_back(parse_kill(kill));
  }
  for (const std::string& process : arguments.without) {
    check_process(process, "--without " + process);
    setup.without.insert(process);
  }
  setup.explores = arguments.explore;
  setup.map.localise_in = arguments.localise;
  setup.map.map_in = arguments.map_in;
  laser3d::check(setup.params.laser3d);
  navigator::check(setup.params.navigator);
  slam6d::check(setup.params.slam6d);
  check_kills(setup);
  check_options(arguments, setup);
  setup.level_laser = arguments.level_laser;
  setup.seed = arguments.seed;
  return setup;
}

// Makes the trial. If that fails, because a map cannot be read, the folder must not be left with a
// log in it: the corrected command would be refused.
std::unique_ptr<Trial> make_or_clean_up(const Arguments& arguments, TrialSetup& setup,
                                        const std::filesystem::path& dir) {
  try {
    if (arguments.appear_s) {
      add_appearing_obstacle(setup, *arguments.appear_s, dir);
    }
    return std::make_unique<Trial>(setup, dir);
  } catch (...) {
    remove_logs(dir);
    std::error_code ignored;  // it stays if somebody else has put something into it
    std::filesystem::remove(dir, ignored);
    throw;
  }
}

void run(const Arguments& arguments, TrialSetup setup) {
  const std::filesystem::path dir = arguments.out;
  setup.world = sim::make_world(arguments.world);
  if (arguments.no_actors) {
    setup.world.actors.clear();
  }
  if (setup.explores) {
    setup.world.goals.clear();  // a goal would end the exploration
    setup.world.goal_heading_rad.reset();
  }
  setup.duration = time::from_seconds(duration_s(arguments, setup.world));
  if (setup.level_laser && std::ranges::any_of(setup.world.actors, [&](const sim::Actor& a) {
        return a.reacts || a.has_legs || setup.params.world.legs;
      })) {
    throw node::UsageError("--level-laser: not in a world with actors that react or have legs");
  }
  node::make_result_dir(dir);
  const std::clock_t cpu_start = std::clock();
  const auto start = std::chrono::steady_clock::now();
  const std::unique_ptr<Trial> trial = make_or_clean_up(arguments, setup, dir);
  {
    node::Progress progress(kName, setup.duration.count());
    while (trial->step()) {
      progress.show((trial->now() - trial->record().started.value_or(trial->now())).count());
    }
  }
  const TrialOutcome outcome = trial->finish();
  const double cpu_s = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  nlohmann::ordered_json result = summarise(setup, outcome, dir);
  write_path_image(setup, outcome, dir);
  formats::write_tum(dir / "truth.tum", true_trajectory(outcome.record, false));
  formats::write_tum(dir / "odometry.tum", outcome.record.odometry);
  // The values that differ from run to run.
  const double simulated_s = time::seconds(outcome.record.truth.back().instant.time_since_epoch());
  result["realtime_factor"] = simulated_s / wall_s;
  result["wall_s"] = wall_s;
  result["cpu_s"] = cpu_s;
  node::write_result_json(dir, result);
}

int run_trial(int argc, char** argv) {
  Arguments arguments;
  TrialSetup setup;
  return node::run_program(
      argc, argv,
      {.name = kName,
       .summary = "Runs the whole robot in a simulated world, faster than real time.",
       .log_level = "error",
       .add_options = [&arguments](CLI::App& app) { add_options(app, arguments); },
       .check =
           [&] {
             setup = make_setup(arguments);
             if (!arguments.dump_params && (arguments.world.empty() || arguments.out.empty())) {
               throw node::UsageError("--world and --out must be given");
             }
           },
       .run =
           [&](const std::string& /*lcm_url*/) {
             if (arguments.dump_params) {
               std::cout << setup.params.to_yaml();
             } else {
               run(arguments, std::move(setup));
             }
             return 0;
           }});
}

}  // namespace
}  // namespace nodmap::trial

int main(int argc, char** argv) {
  return nodmap::trial::run_trial(argc, argv);
}
