// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <chrono>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/bus/live_bus.hpp"
#include "common/bus/replay_bus.hpp"
#include "common/log/log.hpp"
#include "common/node/command_line.hpp"
#include "common/node/node.hpp"
#include "common/node/progress.hpp"
#include "common/node/status.hpp"
#include "common/node/stop_signal.hpp"
#include "common/time/clock.hpp"

namespace nodmap::node {
namespace {

using SteadyClock = std::chrono::steady_clock;

struct Options {
  CommonOptions common;
  std::string replay;
  std::string out;
};

double seconds_since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

/// What result.json says of every process; the module's own figures come under "figures".
nlohmann::json common_result(const ProgramInfo& info, bus::Bus& bus, const Tally& tally) {
  const bus::LatencyMeter::Summary latency = bus.latency().summary();
  nlohmann::json rejected = nlohmann::json::object();
  for (const auto& [cause, count] : tally.rejected()) {
    rejected[cause] = count;
  }
  return {
      {"process", info.name},
      {"version", NODMAP_VERSION},
      {"messages",
       {{"read", bus.counts().received},
        {"used", tally.used()},
        {"rejected", rejected},
        {"corrupt", bus.counts().corrupt},
        {"lost", tally.lost()},
        {"published", bus.counts().published},
        {"not_published", bus.counts().not_published}}},
      {"message_us", {{"p50", latency.p50_us}, {"p99", latency.p99_us}, {"max", latency.max_us}}}};
}

void write_result_json(const std::filesystem::path& dir, const nlohmann::json& result) {
  std::ofstream out(dir / "result.json");
  out << result.dump(2) << "\n";
  out.flush();
  if (!out) {
    throw std::runtime_error((dir / "result.json").string() + ": cannot write");
  }
}

int run_replay(const ProgramInfo& info, const Options& options, const NodeFactory& make_node) {
  const std::filesystem::path dir = options.out;
  make_result_dir(dir);
  bus::ReplayBus bus(options.replay, dir / "out.lcmlog");
  Tally tally;
  Context context{bus, tally, dir};
  const std::unique_ptr<Node> node = make_node(context);

  const auto start = SteadyClock::now();
  std::int64_t first_utime_us = 0;
  {
    Progress progress(info.name, bus.reader().size_bytes());
    while (!stop_requested() && bus.step()) {
      first_utime_us = bus.events_read() == 1 ? bus.log_utime_us() : first_utime_us;
      progress.show(bus.reader().position_bytes());
    }
  }
  node->finish();
  const double wall_s = seconds_since(start);
  const double log_s = 1e-6 * static_cast<double>(bus.log_utime_us() - first_utime_us);

  node->write_results(dir);
  nlohmann::json result = common_result(info, bus, tally);
  result["log"] = {{"file", std::filesystem::path(options.replay).filename().string()},
                   {"events", bus.events_read()},
                   {"skipped_bytes", bus.reader().skipped_bytes()},
                   {"duration_s", log_s}};
  result["wall_s"] = wall_s;
  result["realtime_factor"] = wall_s > 0.0 ? log_s / wall_s : 0.0;
  result["interrupted"] = stop_requested();
  result["figures"] = node->figures();
  write_result_json(dir, result);
  if (!bus.flush() || bus.counts().not_published > 0) {
    throw std::runtime_error((dir / "out.lcmlog").string() + ": the disk takes no more");
  }
  log::get().info("{} of {} messages used, {:.2f} s, results in {}", tally.used(),
                  bus.counts().received, wall_s, dir.string());
  return 0;
}

int run_live(const ProgramInfo& info, const Options& options, const NodeFactory& make_node) {
  const std::filesystem::path dir = make_next_result_dir(options.out);
  bus::LiveBus bus(options.common.lcm_url);
  Tally tally;
  Context context{bus, tally, dir};
  const std::unique_ptr<Node> node = make_node(context);
  const time::SystemClock clock;
  StatusReporter status(info.name, bus, tally, clock);
  log::get().info("listening on {}", bus.url());

  const auto start = SteadyClock::now();
  while (!stop_requested()) {
    // The wait bounds how late a STATUS or the answer to a signal can be.
    bus.handle(std::chrono::milliseconds(50));
    status.publish_if_due(*node);
  }
  node->finish();
  if (!dir.empty()) {
    node->write_results(dir);
    nlohmann::json result = common_result(info, bus, tally);
    result["wall_s"] = seconds_since(start);
    result["figures"] = node->figures();
    write_result_json(dir, result);
    log::get().info("results in {}", dir.string());
  }
  return 0;
}

}  // namespace

int run_process(int argc, char** argv, const ProgramInfo& info, params::Table& table,
                const NodeFactory& make_node) {
  Options options;
  CLI::App app(info.summary, info.name);
  add_common_options(app, options.common, table);
  auto* out = app.add_option(
      "--out", options.out,
      "Folder for the results; made, and never overwritten: live, DIR.2 follows DIR");
  app.add_option("--replay", options.replay,
                 "Work through this LCM event log instead of the network, as fast as possible")
      ->needs(out);
  if (const auto code = parse_command_line(app, argc, argv)) {
    return *code;
  }
  if (const auto code = apply_common_options(info.name, options.common, table)) {
    return *code;
  }
  catch_stop_signals();
  try {
    return options.replay.empty() ? run_live(info, options, make_node)
                                  : run_replay(info, options, make_node);
  } catch (const std::exception& error) {
    log::get().error("{}", error.what());
    return 1;
  }
}

}  // namespace nodmap::node
