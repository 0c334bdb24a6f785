// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/process_feed.hpp"

#include "common/node/messages.hpp"

namespace nodmap::foxglove {
namespace {

constexpr std::size_t kLogLines = 500;

}  // namespace

ProcessFeed::ProcessFeed(bus::Bus& bus, TopicStore& store, node::MessageCounts& counts)
    : store_(store), counts_(counts) {
  subscribe_status(bus);
  subscribe_info(bus);
}

void ProcessFeed::reset() {
  processes_.clear();
  commands_.clear();
}

void ProcessFeed::set_configured_commands(const procman::Config& config) {
  commands_.set_configured(config);
  post_commands({});
}

void ProcessFeed::subscribe_status(bus::Bus& bus) {
  const std::size_t table = store_.add({"STATUS", "nodmap.processes"});
  const std::size_t log = store_.add({"log", "foxglove.Log", Keep::kAll, kLogLines});
  const auto on_status = [=, this](const nodmap::status_t& message) {
    const ProcessTable::Change change = processes_.update(message);
    if (!change.taken) {
      counts_.reject("too_many_processes");
      return;
    }
    counts_.use();
    store_.post(table, node::stamp_of(message), [this] { return to_text(processes_.processes()); });
    if (change.health_changed) {
      store_.post(log, node::stamp_of(message), [message] { return to_text(health_log(message)); });
    }
  };
  bus.subscribe<nodmap::status_t>("STATUS", on_status, kFeedQueue);
}

void ProcessFeed::subscribe_info(bus::Bus& bus) {
  commands_topic_ = store_.add({"PM_INFO", "nodmap.commands"});
  const auto on_info = [this](const procman_lcm::deputy_info_t& message) {
    if (!commands_.update(message)) {
      counts_.reject("too_many_commands");
      return;
    }
    counts_.use();
    post_commands(node::stamp_of(message));
  };
  bus.subscribe<procman_lcm::deputy_info_t>("PM_INFO", on_info, kFeedQueue);
}

void ProcessFeed::post_commands(time::Timestamp stamp) {
  store_.post(commands_topic_, stamp, [this] { return to_text(commands_.commands()); });
}

}  // namespace nodmap::foxglove
