// SPDX-License-Identifier: BSD-3-Clause
// nodmap-watch: shows the robot's state on one line; at the end writes a summary as JSON.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "common/bus/live_bus.hpp"
#include "common/geometry/clock.hpp"
#include "common/node/log.hpp"
#include "common/node/messages.hpp"
#include "common/node/option_checks.hpp"
#include "common/node/program.hpp"
#include "tools/watch/display.hpp"
#include "tools/watch/overview.hpp"

namespace nodmap::watch {
namespace {

struct Arguments {
  double duration_s = 0.0;
  double patience_s = 30.0;
  bool until_home = false;
  std::string out;
};

template <class Message>
void listen(bus::Bus& bus, const char* channel, Overview& overview) {
  bus.subscribe<Message>(
      channel, [&overview](const Message& message) { overview.add(message, time::steady_now()); });
}

void listen_to_all(bus::Bus& bus, Overview& overview) {
  listen<nodmap::scan_t>(bus, "SCAN", overview);
  listen<nodmap::odometry_t>(bus, "ODOMETRY", overview);
  listen<nodmap::pitch_state_t>(bus, "PITCH_STATE", overview);
  listen<nodmap::egomap_t>(bus, "OBSTACLE_MAP", overview);
  listen<nodmap::navigation_t>(bus, "NAVIGATION", overview);
  listen<nodmap::cloud_chunk_t>(bus, "CLOUD", overview);
  listen<nodmap::exploration_t>(bus, "EXPLORATION", overview);
  listen<nodmap::status_t>(bus, "STATUS", overview);
  listen<nodmap::truth_t>(bus, "TRUTH", overview);
}

// Returns true after the full duration; false if no scan was received, if it was stopped early, or
// if the robot was to come home and has not.
bool watch(const Arguments& arguments, const std::string& lcm_url, Overview& overview) {
  bus::LiveBus bus(lcm_url);
  listen_to_all(bus, overview);
  Display display(std::cout, ::isatty(STDOUT_FILENO) == 1);

  time::SteadyTime end = time::steady_now() + time::from_seconds(arguments.patience_s);
  bool scans_came = false;
  bool in_time = true;
  while (in_time && !node::stop_requested()) {
    bus.handle(20ms);
    const time::SteadyTime now = time::steady_now();
    if (!scans_came && overview.scans().total() > 0) {
      scans_came = true;
      end = now + time::from_seconds(arguments.duration_s);
    }
    display.show(overview, now);
    in_time = (now < end || (scans_came && arguments.duration_s == 0.0)) &&
              !(arguments.until_home && (overview.is_home() || overview.given_up()));
  }
  display.end(overview, time::steady_now());
  return scans_came && !in_time && (!arguments.until_home || overview.is_home());
}

nlohmann::ordered_json summary(const Overview& overview) {
  nlohmann::ordered_json processes;
  for (const auto& [name, process] : overview.processes()) {
    processes[name] = {{"health", process.health},         {"reason", process.reason},
                       {"handled", process.total_handled}, {"lost", process.lost},
                       {"corrupt", process.corrupt},       {"rejected", process.rejected},
                       {"latency_p99_us", process.p99_us}};
  }
  return {{"distance_m", overview.distance_m()},
          {"max_forward_mps", overview.max_forward_mps()},
          {"scans", overview.scans().total()},
          {"odometry", overview.odometry().total()},
          {"keyframes", overview.keyframes()},
          {"is_home", overview.is_home()},
          {"seen_m2", overview.seen_m2()},
          {"lost", overview.lost()},
          {"collisions", overview.collisions()},
          {"bumps", overview.bumps()},
          {"processes", processes}};
}

void add_options(CLI::App& app, Arguments& arguments) {
  app.add_option("--duration", arguments.duration_s,
                 "Seconds from the first scan on; 0: until stopped")
      ->check(node::at_least_zero())
      ->capture_default_str();
  app.add_flag("--until-home", arguments.until_home,
               "Exit when the explorer reports that the robot is home, or gives up; exit code 1 if "
               "the robot "
               "has not come home");
  app.add_option("--patience", arguments.patience_s, "Seconds to wait for the first scan")
      ->check(node::above_zero())
      ->capture_default_str();
  app.add_option("--json", arguments.out, "Write a summary to this file");
}

int run(const Arguments& arguments, const std::string& lcm_url) {
  Overview overview;
  const bool done = watch(arguments, lcm_url, overview);
  if (overview.scans().total() == 0) {
    log::get().error("no SCAN received");
  } else if (arguments.until_home && !overview.is_home()) {
    log::get().error("the robot is not home: {}",
                     node::read_name(overview.given_up().value_or("not in time")));
  }
  if (!arguments.out.empty()) {
    std::ofstream file(arguments.out);
    // Names of processes may be any bytes, but JSON is UTF-8.
    file << summary(overview).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
    if (!file.flush()) {
      throw std::system_error(errno, std::system_category(), arguments.out + ": cannot write");
    }
  }
  const bool may_be_stopped = arguments.duration_s == 0.0 && !arguments.until_home;
  return done || (may_be_stopped && overview.scans().total() > 0) ? 0 : 1;
}

}  // namespace
}  // namespace nodmap::watch

int main(int argc, char** argv) {
  using namespace nodmap;
  watch::Arguments arguments;
  return node::run_program(
      argc, argv,
      {.name = "nodmap-watch",
       .summary = "Shows the robot's state on one line.",
       .uses_lcm = true,
       .add_options = [&arguments](CLI::App& app) { watch::add_options(app, arguments); },
       .run = [&arguments](const std::string& lcm_url) { return watch::run(arguments, lcm_url); }});
}
