// SPDX-License-Identifier: BSD-3-Clause
#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/bus/live_bus.hpp"
#include "common/geometry/clock.hpp"
#include "common/node/log.hpp"
#include "common/node/option_checks.hpp"
#include "common/node/program.hpp"
#include "common/node/results.hpp"
#include "common/node/status.hpp"
#include "common/params/params.hpp"
#include "sim/devices/simulated_robot.hpp"
#include "sim/simulator.hpp"
#include "sim/world/scenarios/scenarios.hpp"
#include "sim/world/world_name.hpp"

namespace nodmap::sim {
namespace {

constexpr const char* kName = "nodmap-sim";
constexpr time::Duration kMaxSleep = 2ms;

struct Options {
  std::string world;
  std::uint64_t seed = 1;
  std::string links;
  std::vector<std::string> faults;
  double duration_s = 0.0;  // 0: until a signal
  std::string out;
};

void add_options(CLI::App& app, Options& options) {
  app.add_option("--world", options.world,
                 "World file, SCENARIO:SEED for a generated one, barn:FILE:INDEX, or "
                 "pedestrians:FILE:FRAMES_PER_SECOND:SEED; scenarios: " +
                     scenario_names());
  app.add_option("--seed", options.seed, "Seed of all noise")->capture_default_str();
  app.add_option("--links", options.links,
                 "Folder for the links laser, servo and base; default nodmap-sim-PID in "
                 "$XDG_RUNTIME_DIR or /tmp");
  app.add_option("--fault", options.faults,
                 "A fault: PART:KIND@FROM+DURATION[=AMOUNT]; repeatable");
  app.add_option("--duration", options.duration_s, "Seconds to run; without it until a signal")
      ->check(node::at_least_zero());
  app.add_option("--out", options.out, "Folder for result.json; DIR.2 if it already contains one");
}

std::filesystem::path link_dir(const Options& options) {
  if (!options.links.empty()) {
    return options.links;
  }
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");  // NOLINT(concurrency-mt-unsafe)
  return std::filesystem::path(runtime == nullptr ? "/tmp" : runtime) /
         (std::string(kName) + "-" + std::to_string(::getpid()));
}

// Waits until bytes arrive from the host, or a device has something to do.
void wait_for_work(const Simulator& simulator, time::SteadyTime now) {
  const time::Duration timeout =
      std::clamp<time::Duration>(simulator.next_due() - now, 0s, kMaxSleep);
  const timespec wait{0, timeout / 1ns};
  std::array<pollfd, 3> entries{};
  const std::array<int, 3> handles = simulator.poll_handles();
  std::ranges::transform(handles, entries.begin(), [](int handle) {
    return pollfd{handle, POLLIN, 0};
  });
  ::ppoll(entries.data(), entries.size(), &wait, nullptr);
}

nlohmann::json run_loop(const Options& options, const std::string& lcm_url, SimulatedRobot& robot) {
  bus::LiveBus bus(lcm_url);
  const node::MessageCounts counts;
  const time::SystemClock clock;
  node::StatusReporter status(kName, bus, counts, clock);
  const LinkDir dir(link_dir(options));
  const time::SteadyTime start = time::steady_now();
  const auto simulated_now = [start] { return time::SteadyTime(time::steady_now() - start); };
  Simulator simulator(robot, dir, bus, clock.now());
  log::get().info("on {}, devices in {}", bus.url(), dir.path().string());
  const time::SteadyTime end =
      options.duration_s > 0.0 ? time::SteadyTime(time::from_seconds(options.duration_s)) : kNever;
  std::int64_t second = 0;
  for (time::SteadyTime now{}; !node::stop_requested() && now < end; now = simulated_now()) {
    simulator.spin_once(now);
    status.publish_if_due(simulator.health());
    if (const std::int64_t passed = now.time_since_epoch() / 1s; passed != second) {
      second = passed;
      simulator.reset_lag();
    }
    wait_for_work(simulator, simulated_now());
  }
  return simulator.metrics();
}

// World and faults, as in --world and --fault.
struct Experiment {
  World world;
  std::vector<Fault> faults;
};

Experiment load_experiment(const Options& options) {
  if (options.world.empty()) {
    throw node::UsageError(
        "--world: a world is required, such as sim/worlds/cellar.yaml or corridor:1");
  }
  Experiment experiment{make_world(options.world), {}};
  std::ranges::transform(options.faults, std::back_inserter(experiment.faults),
                         [](const std::string& text) { return parse_fault(text); });
  return experiment;
}

int run(const Options& options, const SimulatedRobotParams& params, const Experiment& experiment,
        const std::string& lcm_url) {
  SimulatedRobot robot(experiment.world, params, experiment.faults, options.seed);
  const node::LiveResultDir out = node::make_next_result_dir(options.out);
  const nlohmann::json metrics = run_loop(options, lcm_url, robot);
  if (!out.path.empty()) {
    node::write_result_json(out.path, metrics);
  }
  log::get().info("ended after {:.1f} s: {} collisions, {} bumps, {:.2f} m driven",
                  metrics["duration_s"].get<double>(), metrics["collisions"].get<std::int64_t>(),
                  metrics["bumps"].get<std::int64_t>(), metrics["distance_m"].get<double>());
  return 0;
}

int run_sim(int argc, char** argv) {
  Options options;
  SimulatedRobotParams params;
  params::Table table(params);
  Experiment experiment;
  return node::run_program(
      argc, argv,
      {.name = kName,
       .summary = "Simulates KURT3D in a world, with its devices on pseudo-terminals.",
       .params = &table,
       .uses_lcm = true,
       .outlives_its_readers = true,
       .add_options = [&options](CLI::App& app) { add_options(app, options); },
       .check = [&] { experiment = load_experiment(options); },
       .run =
           [&](const std::string& lcm_url) { return run(options, params, experiment, lcm_url); }});
}

}  // namespace
}  // namespace nodmap::sim

int main(int argc, char** argv) {
  return nodmap::sim::run_sim(argc, argv);
}
