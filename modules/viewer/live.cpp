// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/live.hpp"

#include <filesystem>
#include <optional>
#include <stdexcept>

#include "common/bus/live_bus.hpp"
#include "common/geometry/clock.hpp"
#include "common/node/log.hpp"
#include "common/node/program.hpp"
#include "common/node/status.hpp"
#include "modules/viewer/access.hpp"
#include "modules/viewer/foxglove/feed.hpp"
#include "modules/viewer/json.hpp"
#include "modules/viewer/process_control.hpp"
#include "modules/viewer/remote_control.hpp"
#include "modules/viewer/viewer.hpp"
#include "procman/config/config_watch.hpp"
#include "procman/config/parser.hpp"

namespace nodmap::viewer {
namespace {

// The configuration of the processes that may be controlled, if any. Throws node::UsageError.
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

// Adopts the configuration if it was edited. Not while a request is open, because that refers to
// the previous one.
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

// Executes a request, and logs it: except for the output of processes, which a page asks for every
// second.
Answer answer_and_log(RemoteControl& control, const Json& request, time::Duration age) {
  Answer answer = control.answer(request, age);
  if (text_in(request, "do") != "process_output") {
    log::get().info("{}", log_line(request, answer));
  }
  return answer;
}

}  // namespace

void run_live(const Options& options, const ViewerParams& params) {
  procman::ConfigWatch config_watch(options.procman, procman::ConfigWatch::kSheriffSettle,
                                    time::steady_now());
  const auto config = load_procman(options.procman);
  bus::LiveBus bus(options.lcm_url);
  const time::SystemClock clock;
  node::MessageCounts counts;
  const Site site;
  foxglove::TopicStore store;
  foxglove::Feed feed(bus, store, counts, params.feed);
  std::optional<ProcessControl> processes;
  if (config) {
    feed.set_configured_commands(*config);
    processes.emplace(bus, *config, time::now_on_both_clocks);
  }
  RemoteControl control(bus, time::now_on_both_clocks, processes ? &*processes : nullptr);
  Viewer viewer(
      options, params, site, store,
      {.name = kProgram,
       .session_id = make_token(),
       .sends_time = false,
       .parameters = {},
       .set_parameter = {},
       .control = [&control](const Json& request,
                             time::Duration age) { return answer_and_log(control, request, age); },
       .controls_processes = processes.has_value()});
  node::StatusReporter status(kProgram, bus, counts, clock);
  log::get().info("listening on {}", bus.url());
  while (!node::stop_requested()) {
    viewer.serve();
    bus.handle(0ms);
    control.poll();
    if (processes) {
      processes->poll();
      reload_procman(config_watch, *processes, feed);
    }
    viewer.poll();
    status.publish_if_due(node::Health{});
  }
}

}  // namespace nodmap::viewer
