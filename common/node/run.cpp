// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/run.hpp"

#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "common/bus/live_bus.hpp"
#include "common/bus/replay_bus.hpp"
#include "common/geometry/clock.hpp"
#include "common/node/log.hpp"
#include "common/node/progress.hpp"
#include "common/node/results.hpp"
#include "common/node/status.hpp"

namespace nodmap::node {
namespace {

using SteadyClock = std::chrono::steady_clock;

struct Options {
  std::string replay;
  std::string out;
};

double seconds_since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

// The part of result.json that is the same for every process; the module's own metrics are under
// "metrics".
nlohmann::json common_result(const ProgramInfo& info, bus::Bus& bus, const MessageCounts& counts) {
  const bus::LatencyMeter::Summary latency = bus.latency().summary();
  return {
      {"process", info.name},
      {"version", NODMAP_VERSION},
      {"messages", messages_json(bus, counts)},
      {"message_us", {{"p50", latency.p50_us}, {"p99", latency.p99_us}, {"max", latency.max_us}}}};
}

// Makes the node of a replay. If that fails, because a map cannot be read, the folder must not be
// left with a log in it: the corrected command would be refused.
std::unique_ptr<Node> make_or_clean_up(const NodeFactory& make_node, Context& context,
                                       const std::filesystem::path& out_log) {
  try {
    return make_node(context);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(out_log, ignored);
    std::filesystem::remove(context.out_dir, ignored);
    throw;
  }
}

void run_replay(const ProgramInfo& info, const Options& options, const NodeFactory& make_node) {
  const std::filesystem::path dir = options.out;
  bus::LogReader(options.replay).require_event();  // before the folder is created
  make_result_dir(dir);
  const std::filesystem::path out_log = dir / "out.lcmlog";
  bus::ReplayBus bus(options.replay, out_log);
  MessageCounts counts;
  Context context{bus, counts, dir};
  const std::unique_ptr<Node> node = make_or_clean_up(make_node, context, out_log);

  const auto start = SteadyClock::now();
  time::Timestamp first{};
  bool is_complete = false;  // a signal after the last message changes nothing
  {
    Progress progress(info.name, bus.reader().size_bytes());
    while (!is_complete && !stop_requested()) {
      is_complete = !bus.step();
      first = bus.events_read() == 1 ? bus.log_time() : first;
      progress.show(bus.reader().position_bytes());
    }
  }
  node->finish();
  const double wall_s = seconds_since(start);
  const double log_s = time::seconds(bus.log_time() - first);

  node->write_results(dir);
  nlohmann::json result = common_result(info, bus, counts);
  result["log"] = {{"file", std::filesystem::path(options.replay).filename().string()},
                   {"events", bus.events_read()},
                   {"skipped_bytes", bus.reader().skipped_bytes()},
                   {"duration_s", log_s}};
  result["wall_s"] = wall_s;
  result["realtime_factor"] = wall_s > 0.0 ? log_s / wall_s : 0.0;
  result["interrupted"] = !is_complete;
  result["metrics"] = node->metrics();
  write_result_json(dir, result);
  if (!bus.flush() || bus.counts().not_published > 0) {
    throw std::system_error(bus.failure(), out_log.string() + ": cannot write");
  }
  if (bus.reader().skipped_bytes() > 0) {
    log::get().warn("{}", bus.reader().damage());
  }
  log::get().info("{} of {} messages used, {:.2f} s, results in {}", counts.used(),
                  bus.counts().received, wall_s, dir.string());
  if (!is_complete) {
    throw std::runtime_error(fmt::format(
        "stopped after {:.1f} s of the log: the results are those of this part", log_s));
  }
  if (counts.used() == 0) {
    throw std::runtime_error(options.replay + ": contains nothing that " + info.name +
                             " could use");
  }
}

void run_live(const ProgramInfo& info, const Options& options, const std::string& lcm_url,
              const NodeFactory& make_node) {
  const LiveResultDir out = make_next_result_dir(options.out);
  const std::filesystem::path& dir = out.path;
  bus::LiveBus bus(lcm_url);
  MessageCounts counts;
  Context context{bus, counts, dir, ResultsUsed::kWhenReady};
  const std::unique_ptr<Node> node = make_node(context);
  const time::SystemClock clock;
  StatusReporter status(info.name, bus, counts, clock);
  log::get().info("listening on {}", bus.url());

  const auto start = SteadyClock::now();
  while (!stop_requested()) {
    // The timeout and bus::HandleLimit limit how late a STATUS or the reaction to a signal can be.
    bus.handle(std::chrono::milliseconds(50));
    status.publish_if_due(*node);
  }
  node->finish();
  if (!dir.empty()) {
    node->write_results(dir);
    nlohmann::json result = common_result(info, bus, counts);
    result["wall_s"] = seconds_since(start);
    result["metrics"] = node->metrics();
    write_result_json(dir, result);
    log::get().info("results in {}", dir.string());
  }
}

int run_with(int argc, char** argv, const ProgramInfo& info, params::Table& table,
             const std::function<void(CLI::App&)>& add_more_options, const NodeFactory& make_node,
             const std::function<void()>& check) {
  Options options;
  const auto add_options = [&](CLI::App& app) {
    auto* out = app.add_option("--out", options.out,
                               "Folder for the results; created, never overwritten. Live, DIR.2 is "
                               "used if DIR contains results or another process uses it");
    app.add_option("--replay", options.replay,
                   "Process this LCM event log instead of the network, as fast as possible")
        ->needs(out);
    add_more_options(app);
  };
  return run_program(argc, argv,
                     {.name = info.name,
                      .summary = info.summary,
                      .params = &table,
                      .uses_lcm = true,
                      .outlives_its_readers = true,
                      .add_options = add_options,
                      .check = check,
                      .run = [&](const std::string& lcm_url) {
                        options.replay.empty() ? run_live(info, options, lcm_url, make_node)
                                               : run_replay(info, options, make_node);
                        return 0;
                      }});
}

}  // namespace

int run_node(int argc, char** argv, const ProgramInfo& info, params::Table& table,
             const NodeFactory& make_node, const std::function<void()>& check) {
  return run_with(
      argc, argv, info, table, [](CLI::App&) {}, make_node, check);
}

int run_map_node(int argc, char** argv, const ProgramInfo& info, params::Table& table,
                 const MapNodeFactory& make_node, const std::function<void()>& check) {
  std::string localise_in;
  std::string map_in;
  std::vector<double> start_pose;  // x, y in m, yaw in degrees
  const auto add_options = [&](CLI::App& app) {
    auto* localise =
        app.add_option("--localise", localise_in,
                       "Localise in this map without changing it: a folder written by "
                       "--out or a save request, or the map file in it: keyframes.lcmlog "
                       "for nodmap-slam6d; map.yaml, also of another program, for "
                       "nodmap-slam2d");
    app.add_option("--map-in", map_in,
                   "Extend this map: a folder written by --out or a save request, with "
                   "keyframes.lcmlog. It is not changed; the extended map is written to --out")
        ->excludes(localise);
    app.add_option("--start-pose", start_pose,
                   "X Y YAW_DEG: the robot's pose in the map at the first scan, in m and degrees; "
                   "without it, the whole map is searched")
        ->expected(3);
    app.parse_complete_callback([&] {
      if (!start_pose.empty() && localise_in.empty() && map_in.empty()) {
        throw CLI::RequiresError("--start-pose", "--localise or --map-in");
      }
    });
  };
  const auto make_map_node = [&](Context& context) {
    MapOptions options{localise_in, map_in, std::nullopt};
    if (!start_pose.empty()) {
      options.T_map_start =
          geometry::SE2{start_pose[0], start_pose[1], geometry::deg_to_rad(start_pose[2])};
    }
    return make_node(context, options);
  };
  return run_with(argc, argv, info, table, add_options, make_map_node, check);
}

}  // namespace nodmap::node
