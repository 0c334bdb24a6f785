// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <boost/core/noncopyable.hpp>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/live_bus.hpp"
#include "common/bus/log_player.hpp"
#include "common/node/clock.hpp"
#include "common/node/cpu_load.hpp"
#include "common/node/log.hpp"
#include "common/node/program.hpp"
#include "common/node/status.hpp"
#include "common/params/params.hpp"
#include "modules/viewer/foxglove/feed.hpp"
#include "modules/viewer/json.hpp"
#include "modules/viewer/log_history.hpp"
#include "modules/viewer/pace.hpp"
#include "modules/viewer/params.hpp"
#include "modules/viewer/playback.hpp"
#include "modules/viewer/process_control.hpp"
#include "modules/viewer/remote_control.hpp"
#include "modules/viewer/server.hpp"
#include "procman/config/config_watch.hpp"
#include "procman/config/parser.hpp"

namespace nodmap::viewer {
namespace {

using std::chrono::milliseconds;

constexpr const char* kProgram = "nodmap-viewer";
/// Number of events delivered in one turn: about ten milliseconds of work.
constexpr std::int64_t kEventsPerTurn = 5000;
constexpr time::Duration kLoadPeriod = 1s;

struct Options {
  std::string lcm_url;
  std::string bind = "127.0.0.1";
  std::uint16_t port = 8765;
  bool control = false;
  std::filesystem::path procman;
  std::vector<std::filesystem::path> replay;
};

void add_options(CLI::App& app, Options& options) {
  app.add_option("--bind", options.bind, "Address to listen on")->capture_default_str();
  app.add_option("--port", options.port,
                 "Port for the page and the WebSocket; 0 selects a free one")
      ->capture_default_str();
  auto* control = app.add_flag(
      "--control", options.control,
      "Allow clients with the printed token to set goals, stop the robot and save maps");
  app.add_option("--procman", options.procman,
                 "Allow them also to start and stop the processes of this configuration (.pmd)")
      ->needs(control);
  app.add_option(
         "--replay", options.replay,
         "Play this LCM event log instead of receiving from LCM; several are merged by time")
      ->excludes(control);
}

/// The viewer without its source of messages.
struct Viewer : private boost::noncopyable {
  Viewer(const Options& options, const ViewerParams& params, Services the_services)
      : services(std::move(the_services)),
        hub{.site = site,
            .store = store,
            .services = services,
            .policy = {.loopback_only = is_loopback(options.bind),
                       .token = options.control ? make_token() : std::string()},
            .max_connections = params.max_clients,
            .idle_timeout_s = params.idle_timeout_s},
        pace(milliseconds(params.update_ms)) {}

  /// Serves all clients once.
  void turn() {
    const time::SteadyTime now = time::steady_now();
    if (now >= load_due) {
      load_due = now + kLoadPeriod;
      load.sample();
      const bool was_slowed = pace.is_slowed();
      pace.note_load(load.share());
      if (pace.is_slowed() != was_slowed) {
        log::get().info(was_slowed ? "clients are updated at the full rate again"
                                   : "the machine is busy: clients are updated less often");
      }
    }
    hub.sends_news = pace.take_turn(now);
    server->turn();
  }

  void open(const Options& options) {
    server.emplace(hub, options.bind, options.port);
    const bool is_v6 = options.bind.find(':') != std::string::npos;
    const std::string host = is_v6 ? "[" + options.bind + "]" : options.bind;
    const std::string page = "http://" + host + ":" + std::to_string(server->port()) + "/";
    log::get().info("page on {}; Foxglove and Lichtblick: ws{}", page, page.substr(4));
    if (!hub.policy.token.empty()) {
      // On stdout, so that the token does not get into a log file.
      std::cout << "control: " << page << "#token=" << hub.policy.token << std::endl;
    }
  }

  ~Viewer() {
    server.reset();
    for (const auto& [cause, count] : hub.counts.rejected()) {
      log::get().info("refused to clients: {} {}", count, cause);
    }
  }

  Site site;
  foxglove::TopicStore store;
  Services services;
  Hub hub;
  std::optional<Server> server;
  node::CpuLoad load;
  Pace pace;
  time::SteadyTime load_due{};
};

/// The configuration of the processes that may be controlled, if any. Throws node::UsageError.
std::optional<procman::Config> load_procman(const std::filesystem::path& file) {
  if (file.empty()) {
    return std::nullopt;
  }
  try {
    return procman::load_config(file);
  } catch (const std::runtime_error& error) {
    throw node::UsageError(error.what());
  }
}

/// Adopts the configuration if it was edited. Not while a request is open, because that refers to
/// the previous one.
void reload_procman(procman::ConfigWatch& watch, ProcessControl& processes, foxglove::Feed& feed) {
  const auto parsed = processes.is_sheriff() ? std::nullopt : watch.poll(time::steady_now());
  if (!parsed) {
    return;
  }
  for (const procman::ConfigError& error : parsed->errors) {
    log::get().error("{} (configuration unchanged)",
                     procman::describe(watch.file().string(), error));
  }
  if (parsed->errors.empty()) {
    processes.set_config(parsed->config);
    feed.set_configured_commands(parsed->config);
    log::get().info("{} was reloaded", watch.file().string());
  }
}

void run_live(const Options& options, const ViewerParams& params) {
  procman::ConfigWatch config_watch(options.procman, procman::ConfigWatch::kSheriffSettle,
                                    time::steady_now());
  const auto config = load_procman(options.procman);
  bus::LiveBus bus(options.lcm_url);
  const time::SystemClock clock;
  node::MessageCounts counts;
  std::optional<ProcessControl> processes;
  if (config) {
    processes.emplace(bus, *config, time::now_on_both_clocks);
  }
  RemoteControl control(bus, clock, processes ? &*processes : nullptr);
  Viewer viewer(options, params,
                {.name = kProgram,
                 .session_id = make_token(),
                 .sends_time = false,
                 .parameters = {},
                 .set_parameter = {},
                 .control =
                     [&control](const Json& request, time::Duration age) {
                       Answer answer = control.answer(request, age);
                       // A page asks for the output of processes every second.
                       if (text_in(request, "do") != "process_output") {
                         log::get().info("asked for {}: {}", foxglove::to_text(request),
                                         answer.text);
                       }
                       return answer;
                     },
                 .controls_processes = processes.has_value()});
  foxglove::Feed feed(bus, viewer.store, counts, params.feed);
  if (config) {
    feed.set_configured_commands(*config);
  }
  node::StatusReporter status(kProgram, bus, counts, clock);
  viewer.open(options);
  log::get().info("listening on {}", bus.url());
  while (!node::stop_requested()) {
    viewer.server->run_for(milliseconds(params.update_ms));
    bus.handle(milliseconds(0));
    control.turn();
    if (processes) {
      processes->turn();
      reload_procman(config_watch, *processes, feed);
    }
    viewer.turn();
    status.publish_if_due(node::Health{});
  }
  viewer.server.reset();
}

void run_replay(const Options& options, const ViewerParams& params) {
  bus::LogPlayer player(options.replay);
  for (const std::string& damage : player.damages()) {
    log::get().warn("{}", damage);
  }
  const std::vector<std::string> events = playback_events(options.replay);
  node::MessageCounts counts;
  bool changed = false;
  bool went_back = false;
  Viewer viewer(options, params,
                {.name = kProgram,
                 .session_id = make_token(),
                 .sends_time = true,
                 .parameters =
                     [&player, &events] {
                       Json parameters = playback_parameters(player);
                       parameters.push_back({{"name", "playback.events"}, {"value", events}});
                       return parameters;
                     },
                 .set_parameter =
                     [&](const std::string& name, const Json& value) {
                       const PlaybackChange change = set_playback_parameter(player, name, value);
                       changed = true;
                       went_back = went_back || change.went_back;
                       return change.refusal;
                     },
                 .control = {},
                 .controls_processes = false});
  viewer.site.add("/history.json", {.content_type = "application/json; charset=utf-8",
                                    .content = foxglove::to_text(log_history(options.replay))});
  foxglove::Feed feed(player, viewer.store, counts, params.feed);
  viewer.open(options);
  auto last = std::chrono::steady_clock::now();
  while (!node::stop_requested()) {
    viewer.server->run_for(milliseconds(params.update_ms));
    const auto now = std::chrono::steady_clock::now();
    player.advance(std::chrono::duration_cast<time::Duration>(now - last));
    last = now;
    if (went_back) {
      viewer.store.clear();
      feed.reset();
      went_back = false;
    }
    player.catch_up(kEventsPerTurn);
    viewer.server->send_time(player.now());
    if (changed) {
      viewer.server->send_changed_parameters();
      changed = false;
    }
    viewer.turn();
  }
  viewer.server.reset();
}

int run(int argc, char** argv) {
  Options options;
  ViewerParams params;
  params::Table table(params);
  return node::run_program(
      argc, argv,
      {.name = kProgram,
       .summary = "Shows the robot live in the browser, and in viewers of Foxglove's protocol.",
       .params = &table,
       .uses_lcm = true,
       .add_options = [&options](CLI::App& app) { add_options(app, options); },
       .run =
           [&](const std::string& lcm_url) {
             options.lcm_url = lcm_url;
             // A client that disconnects while data are sent to it must not end the process.
             std::signal(SIGPIPE, SIG_IGN);
             options.replay.empty() ? run_live(options, params) : run_replay(options, params);
             return 0;
           }});
}

}  // namespace
}  // namespace nodmap::viewer

int main(int argc, char** argv) {
  return nodmap::viewer::run(argc, argv);
}
