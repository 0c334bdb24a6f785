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
#include "common/node/clock.hpp"
#include "common/node/log.hpp"
#include "common/node/program.hpp"
#include "common/node/results.hpp"
#include "common/node/status.hpp"
#include "common/params/params.hpp"
#include "sim/devices/simulated_robot.hpp"
#include "sim/simulator.hpp"
#include "sim/world/world_file.hpp"

namespace nodmap::sim {
namespace {

constexpr const char* kName = "nodmap-sim";
constexpr std::int64_t kMaxSleepUs = 2000;

struct Options {
  std::string world;
  std::uint64_t seed = 1;
  std::string links;
  std::vector<std::string> faults;
  double duration_s = 0.0;  // 0: until a signal
  std::string out;
};

std::int64_t steady_us() {
  using std::chrono::duration_cast;
  using std::chrono::microseconds;
  return duration_cast<microseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("--world", options.world, "The world: WORLD.yaml");
  app.add_option("--seed", options.seed, "Seed of all noise; the same seed gives the same noise")
      ->capture_default_str();
  app.add_option("--links", options.links,
                 "Folder for the links laser, servo and base; default nodmap-sim-PID in "
                 "$XDG_RUNTIME_DIR or /tmp");
  app.add_option("--fault", options.faults,
                 "A fault: PART:KIND@FROM+DURATION[=AMOUNT]; repeatable");
  app.add_option("--duration", options.duration_s, "Seconds to run; without it until a signal")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--out", options.out, "Folder for result.json; where there is one already, DIR.2");
}

std::filesystem::path link_dir(const Options& options) {
  if (!options.links.empty()) {
    return options.links;
  }
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");  // NOLINT(concurrency-mt-unsafe)
  return std::filesystem::path(runtime == nullptr ? "/tmp" : runtime) /
         (std::string(kName) + "-" + std::to_string(::getpid()));
}

/// Waits until bytes arrive from the host, or a device has something to do.
void wait_for_work(const Simulator& simulator, std::int64_t now_us) {
  const std::int64_t wait_us =
      std::clamp<std::int64_t>(simulator.next_us() - now_us, 0, kMaxSleepUs);
  const timespec wait{0, 1000 * wait_us};
  std::array<pollfd, 3> entries{};
  const std::array<int, 3> handles = simulator.poll_handles();
  std::transform(handles.begin(), handles.end(), entries.begin(), [](int handle) {
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
  const std::int64_t start_us = steady_us();
  Simulator simulator(robot, dir, bus, time::to_utime(clock.now()));
  log::get().info("on {}, devices in {}", bus.url(), dir.path().string());
  const auto end_us = options.duration_s > 0.0 ? std::llround(1e6 * options.duration_s) : kNever;
  std::int64_t second = 0;
  for (std::int64_t now_us = 0; !node::stop_requested() && now_us < end_us;
       now_us = steady_us() - start_us) {
    simulator.spin_once(now_us);
    status.publish_if_due(simulator.health());
    if (now_us / 1'000'000 != std::exchange(second, now_us / 1'000'000)) {
      simulator.reset_lag();
    }
    wait_for_work(simulator, steady_us() - start_us);
  }
  return simulator.metrics();
}

/// World and faults as given by --world and --fault.
struct Scenario {
  World world;
  std::vector<Fault> faults;
};

Scenario load_scenario(const Options& options) {
  if (options.world.empty()) {
    throw node::UsageError("--world: is missing; name a WORLD.yaml");
  }
  Scenario scenario{load_world(options.world), {}};
  std::transform(options.faults.begin(), options.faults.end(), std::back_inserter(scenario.faults),
                 [](const std::string& text) { return parse_fault(text); });
  return scenario;
}

int run(const Options& options, const SimulatedRobotParams& params, const Scenario& scenario,
        const std::string& lcm_url) {
  SimulatedRobot robot(scenario.world, params, scenario.faults, options.seed);
  const std::filesystem::path out = node::make_next_result_dir(options.out);
  const nlohmann::json metrics = run_loop(options, lcm_url, robot);
  if (!out.empty()) {
    node::write_result_json(out, metrics);
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
  Scenario scenario;
  return node::run_program(
      argc, argv,
      {.name = kName,
       .summary = "The KURT3D in a simulated world, its devices on pseudo-terminals.",
       .params = &table,
       .uses_lcm = true,
       .add_options = [&options](CLI::App& app) { add_options(app, options); },
       .check = [&] { scenario = load_scenario(options); },
       .run = [&](const std::string& lcm_url) { return run(options, params, scenario, lcm_url); }});
}

}  // namespace
}  // namespace nodmap::sim

int main(int argc, char** argv) {
  return nodmap::sim::run_sim(argc, argv);
}
