// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/sheriff.hpp"

#include <algorithm>
#include <utility>

#include "nodmap/status_t.hpp"
#include "procman/protocol/messages.hpp"
#include "procman/protocol/sheriff_messages.hpp"

namespace nodmap::procman {
namespace {

ProcessHealth health_of(const nodmap::status_t& message) {
  ProcessHealth health;
  health.state = message.health == nodmap::status_t::OK         ? ProcessHealth::State::kOk
                 : message.health == nodmap::status_t::DEGRADED ? ProcessHealth::State::kDegraded
                                                                : ProcessHealth::State::kFailed;
  health.reason = message.health_reason;
  health.handled_per_s = message.handled_per_s;
  health.latency_p50_us = message.latency_p50_us;
  health.latency_p99_us = message.latency_p99_us;
  health.lost = message.total_lost;
  health.rejected = message.total_rejected;
  return health;
}

}  // namespace

Sheriff::Sheriff(Config config, const std::string& lcm_url)
    : config_(std::move(config)),
      bus_(lcm_url),
      fleet_(config_, sheriff_id_prefix() + std::to_string(time::to_utime(clock_.now()))),
      health_(config_) {
  subscribe();
  publish_discovery(bus_, fleet_, clock_.now());
}

Sheriff::~Sheriff() {
  if (has_given_orders_) {
    publish_discovery(bus_, fleet_, clock_.now());
  }
}

void Sheriff::subscribe() {
  bus_.subscribe<nodmap::runs_t>(kRunsChannel, [this](const auto& message) {
    fleet_.take_runs(from_message(message), now(), bus_.origin().sender);
  });
  bus_.subscribe<procman_lcm::deputy_info_t>(kInfoChannel, [this](const auto& message) {
    are_orders_wanted_ |= fleet_.take_info(from_message(message), now(), bus_.origin().sender);
  });
  bus_.subscribe<procman_lcm::orders_t>(kOrdersChannel, [this](const auto& message) {
    fleet_.take_orders(from_message(message), now(), bus_.origin().sender);
  });
  bus_.subscribe<procman_lcm::output_t>(
      kOutputChannel, [this](const auto& message) { take_output(from_message(message)); });
  bus_.subscribe<procman_lcm::output_t>(
      kLastOutputChannel, [this](const auto& message) { take_last_output(from_message(message)); });
  bus_.subscribe<nodmap::status_t>("STATUS", [this](const auto& message) {
    health_.take_status(message.process_name, health_of(message), fleet_, now(),
                        bus_.origin().sender);
  });
}

// Whether the output being handled comes from where its deputy reports from, as far as known.
bool Sheriff::is_from_deputy(const Output& output) const {
  const std::optional<bus::Sender> deputy = fleet_.deputies().sender_of(output.deputy_id, now());
  return !deputy || *deputy == bus_.origin().sender;
}

void Sheriff::take_output(const Output& output) {
  if (!is_from_deputy(output)) {
    return;
  }
  for (const CommandOutput& part : output.outputs) {
    if (output_handler_) {
      output_handler_(part.command_id, part.text);
    }
    // Ignores unknown names, which any sender may use.
    if (fleet_.find(part.command_id) != nullptr) {
      consoles_[part.command_id].take(part.text);
      health_.take_output(part.command_id, now());
    }
  }
}

// It is no sign of life, and deputies repeat it for other sheriffs as well.
void Sheriff::take_last_output(const Output& output) {
  if (!is_from_deputy(output)) {
    return;
  }
  for (const CommandOutput& part : output.outputs) {
    if (last_output_handler_) {
      last_output_handler_(part.command_id, part.text);
    }
    if (fleet_.find(part.command_id) != nullptr && !consoles_.contains(part.command_id)) {
      consoles_[part.command_id].take(part.text);
    }
  }
}

void Sheriff::work(std::chrono::milliseconds wait) {
  bus_.handle(wait);
  if (are_orders_wanted_ || now() >= orders_due_) {
    give_orders();
  }
}

void Sheriff::give_orders() {
  are_orders_wanted_ = false;
  orders_due_ = now() + kOrdersPeriod;
  if (!fleet_.is_in_command()) {
    return;
  }
  has_given_orders_ = true;
  publish_orders(bus_, fleet_, clock_.now());
}

std::vector<HealthWatch::Restart> Sheriff::apply_health_rules() {
  if (!fleet_.is_in_command()) {
    return {};
  }
  std::vector<HealthWatch::Restart> restarts = health_.due_restarts(fleet_, now());
  for (const HealthWatch::Restart& restart : restarts) {
    fleet_.restart(restart.command_id);
  }
  if (!restarts.empty()) {
    give_orders();
  }
  return restarts;
}

std::vector<std::string> Sheriff::reconfigure(Config config) {
  config_ = std::move(config);
  std::vector<std::string> changes = fleet_.reconfigure(config_);
  give_orders();
  return changes;
}

bool Sheriff::is_healthy(const std::string& command) const {
  const Fleet::Item* item = fleet_.find(command);
  const auto status = health_.last_status_of(command);
  return item != nullptr && status && status->health.state == ProcessHealth::State::kOk &&
         status->received >= item->running_since && now() - status->received < node::kStatusSilence;
}

const Console* Sheriff::console(const std::string& command) const {
  const auto found = consoles_.find(command);
  return found == consoles_.end() ? nullptr : &found->second;
}

std::vector<std::string> Sheriff::warnings() const {
  return procman::warnings(fleet_, health_, now());
}

std::vector<ReportRow> Sheriff::report() const {
  return procman::report(fleet_, health_, consoles_, now());
}

}  // namespace nodmap::procman
