// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/process_feed.hpp"

#include <algorithm>

#include "common/node/messages.hpp"
#include "common/node/status.hpp"

namespace nodmap::foxglove {
namespace {

constexpr std::size_t kLogLines = 500;

// A STATUS in whose name another process sends, too.
nodmap::status_t contested(nodmap::status_t status) {
  status.health = std::max(status.health, nodmap::status_t::DEGRADED);
  status.health_reason += status.health_reason.empty() ? "" : "; ";
  status.health_reason += "another process sends STATUS under this name and is ignored";
  return status;
}

}  // namespace

ProcessFeed::ProcessFeed(bus::Bus& bus, TopicStore& store, node::MessageCounts& counts)
    : bus_(bus), store_(store), counts_(counts) {
  subscribe_status(bus);
  subscribe_info(bus);
}

void ProcessFeed::reset() {
  processes_.clear();
  commands_.clear();
  status_senders_.clear();
  info_senders_.clear();
}

// Whether the message being handled is from the process that is shown under its name.
ProcessFeed::Trust ProcessFeed::follow(Senders& senders, const std::string& name) const {
  const bus::Origin& origin = bus_.origin();
  const time::SteadyTime now = origin.arrived;
  const std::pair key(name, origin.sender.address);
  if (!senders.contains(key) && senders.size() >= ProcessTable::kMaxProcesses) {
    return Trust::kTooMany;
  }
  // After so long another process may report under the name.
  bus::SenderWatch& watch = senders.try_emplace(key, node::kStatusSilence).first->second;
  if (!watch.follow(origin.sender, now)) {
    return Trust::kRefused;
  }
  return watch.is_contested(now) ? Trust::kContested : Trust::kAlone;
}

void ProcessFeed::set_configured_commands(const procman::Config& config) {
  commands_.set_configured(config);
  post_commands({});
}

void ProcessFeed::subscribe_status(bus::Bus& bus) {
  const std::size_t table = store_.add({"STATUS", "nodmap.processes"});
  const std::size_t log = store_.add({"log", "foxglove.Log", Keep::kAll, kLogLines});
  const auto on_status = [=, this](const nodmap::status_t& received) {
    const Trust trust = follow(status_senders_, received.process_name);
    if (trust == Trust::kRefused) {
      counts_.reject("other_sender_of_status");
      return;
    }
    const nodmap::status_t message = trust == Trust::kContested ? contested(received) : received;
    const ProcessTable::Change change = trust == Trust::kTooMany
                                            ? ProcessTable::Change{}
                                            : processes_.update(message, bus_.origin().received);
    if (!change.taken) {
      counts_.reject("too_many_processes");
      return;
    }
    counts_.use();
    store_.post(table, node::stamp_of(message), [this] { return to_text(processes_.processes()); });
    if (commands_.advance(bus_.origin().received)) {
      post_commands(node::stamp_of(message));
    }
    if (change.health_changed) {
      store_.post(log, node::stamp_of(message), [message] { return to_text(health_log(message)); });
    }
  };
  bus.subscribe<nodmap::status_t>("STATUS", on_status, kFeedQueue);
}

void ProcessFeed::subscribe_info(bus::Bus& bus) {
  commands_topic_ = store_.add({"PM_INFO", "nodmap.commands"});
  const auto on_info = [this](const procman_lcm::deputy_info_t& message) {
    const Trust trust = follow(info_senders_, message.deputy_id);
    if (trust == Trust::kRefused) {
      counts_.reject("other_sender_of_pm_info");
      return;
    }
    if (trust == Trust::kTooMany || !commands_.update(message, bus_.origin().received)) {
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
