// SPDX-License-Identifier: BSD-3-Clause
// nodmap-latency: measures the time from a scan to the map that contains it and to the next
// command.
#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/bus/event_log.hpp"
#include "common/bus/live_bus.hpp"
#include "common/node/log.hpp"
#include "common/node/option_checks.hpp"
#include "common/node/program.hpp"
#include "tools/latency/reaction.hpp"

namespace nodmap::latency {
namespace {

constexpr int kQueue = 1000;
constexpr std::size_t kParts = 10;

void listen(const std::string& url, double duration_s, Reaction& reaction) {
  using Clock = std::chrono::steady_clock;
  bus::LiveBus bus(url);
  bus.subscribe_all(
      [&reaction](const bus::LiveBus::RawMessage& message) {
        reaction.add(message.channel, message.data, message.received);
      },
      kQueue);
  const auto end = Clock::now() + std::chrono::duration<double>(duration_s);
  while (!node::stop_requested() && Clock::now() < end) {
    bus.handle(std::chrono::milliseconds(50));
  }
}

void read_log(const std::string& file, Reaction& reaction) {
  bus::LogReader reader(file);
  reader.require_event();
  while (const bus::LogEvent* event = reader.next()) {
    reaction.add(event->channel, event->data, time::from_utime(event->log_utime_us));
  }
  if (reader.skipped_bytes() > 0) {
    log::get().warn("{}", reader.damage());
  }
}

nlohmann::ordered_json to_json(const std::vector<Sample>& samples) {
  const Summary summary = summarize(samples);
  return {{"n", summary.n},
          {"p50_us", time::to_us(summary.p50)},
          {"p99_us", time::to_us(summary.p99)},
          {"max_us", time::to_us(summary.max)},
          {"p99_us_over_time", us_over_time(samples, kParts, &Summary::p99)}};
}

struct Arguments {
  std::string replay;
  double duration_s = 60.0;
};

void add_options(CLI::App& app, Arguments& arguments) {
  auto* duration = app.add_option("--duration", arguments.duration_s, "How long to listen, seconds")
                       ->check(node::above_zero())
                       ->capture_default_str();
  app.add_option("--replay", arguments.replay, "Measure in this recording of nodmap-logger instead")
      ->excludes(duration);
}

int run(const Arguments& arguments, const std::string& lcm_url) {
  Reaction reaction;
  arguments.replay.empty() ? listen(lcm_url, arguments.duration_s, reaction)
                           : read_log(arguments.replay, reaction);
  const nlohmann::ordered_json result = {{"scans", reaction.scans()},
                                         {"lost", reaction.lost()},
                                         {"corrupt", reaction.corrupt()},
                                         {"scan_to_obstacle_map", to_json(reaction.scan_to_map())},
                                         {"scan_to_drive", to_json(reaction.scan_to_drive())}};
  std::cout << result.dump(2) << "\n";
  if (reaction.scan_to_map().empty()) {
    log::get().error("no SCAN was followed by an OBSTACLE_MAP");
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace nodmap::latency

int main(int argc, char** argv) {
  using namespace nodmap;
  latency::Arguments arguments;
  return node::run_program(
      argc, argv,
      {.name = "nodmap-latency",
       .summary = "Measures the time from each SCAN to its OBSTACLE_MAP and to the next DRIVE, as "
                  "JSON.",
       .uses_lcm = true,
       .add_options = [&arguments](CLI::App& app) { latency::add_options(app, arguments); },
       .run =
           [&arguments](const std::string& lcm_url) { return latency::run(arguments, lcm_url); }});
}
