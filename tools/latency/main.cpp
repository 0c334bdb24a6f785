// SPDX-License-Identifier: BSD-3-Clause
// nodmap-latency: how long the robot takes from a scan to the map with it and to the command after
// it.
#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/bus/event_log.hpp"
#include "common/bus/live_bus.hpp"
#include "common/node/command_line.hpp"
#include "common/node/stop_signal.hpp"
#include "common/params/params.hpp"
#include "tools/latency/reaction.hpp"

namespace nodmap::latency {
namespace {

constexpr const char* kProgram = "nodmap-latency";
constexpr int kQueue = 1000;
constexpr std::size_t kParts = 10;

/// This program has none, but the options every process has.
struct LatencyParams {
  template <class Visitor>
  void describe(Visitor& /*v*/) {}
};

void listen(const std::string& url, double duration_s, Reaction& reaction) {
  using Clock = std::chrono::steady_clock;
  bus::LiveBus bus(url);
  bus.subscribe_all(
      [&reaction](const bus::LiveBus::RawMessage& message) {
        reaction.hear(message.channel, message.data, message.receive_utime_us);
      },
      kQueue);
  const auto end = Clock::now() + std::chrono::duration<double>(duration_s);
  while (!node::stop_requested() && Clock::now() < end) {
    bus.handle(std::chrono::milliseconds(50));
  }
}

void read_log(const std::string& file, Reaction& reaction) {
  bus::LogReader reader(file);
  while (const bus::LogEvent* event = reader.next()) {
    reaction.hear(event->channel, event->data, event->log_utime_us);
  }
}

nlohmann::ordered_json to_json(const std::vector<Sample>& samples) {
  const Summary summary = summarize(samples);
  return {{"n", summary.n},
          {"p50_us", summary.p50_us},
          {"p99_us", summary.p99_us},
          {"max_us", summary.max_us},
          {"p99_us_over_time", p99_over_time(samples, kParts)}};
}

int run(int argc, char** argv) {
  LatencyParams params;
  params::Table table(params);
  node::CommonOptions options;
  std::string log;
  double duration_s = 60.0;
  CLI::App app(
      "Measures, as JSON, the time from each SCAN to the OBSTACLE_MAP with it and to the DRIVE "
      "that "
      "follows.",
      kProgram);
  node::add_common_options(app, options, table);
  app.add_option("--duration", duration_s, "How long to listen, seconds")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--log", log, "Measure in this recording of nodmap-logger instead");
  if (const auto code = node::parse_command_line(app, argc, argv)) {
    return *code;
  }
  if (const auto code = node::apply_common_options(kProgram, options, table)) {
    return *code;
  }
  node::catch_stop_signals();
  Reaction reaction;
  log.empty() ? listen(options.lcm_url, duration_s, reaction) : read_log(log, reaction);
  const nlohmann::ordered_json result = {{"scans", reaction.scans()},
                                         {"lost", reaction.lost()},
                                         {"corrupt", reaction.corrupt()},
                                         {"scan_to_obstacle_map", to_json(reaction.scan_to_map())},
                                         {"scan_to_drive", to_json(reaction.scan_to_drive())}};
  std::cout << result.dump(2) << "\n";
  return reaction.scan_to_map().empty() ? 1 : 0;
}

}  // namespace
}  // namespace nodmap::latency

int main(int argc, char** argv) {
  try {
    return nodmap::latency::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "nodmap-latency: " << error.what() << "\n";
    return 1;
  }
}
