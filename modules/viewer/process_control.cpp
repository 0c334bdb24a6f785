// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/process_control.hpp"

#include <algorithm>

#include "common/node/process_names.hpp"
#include "procman/config/exec_line.hpp"
#include "procman/protocol/messages.hpp"
#include "procman/protocol/sheriff_messages.hpp"

namespace nodmap::viewer {
namespace {

using procman::Verb;

Answer no_such_command(const std::string& command) {
  return {.ok = false, .text = "There is no command \"" + command + "\"."};
}

}  // namespace

ProcessControl::ProcessControl(bus::Bus& bus, procman::Config config, Clock clock)
    : bus_(bus),
      config_(std::move(config)),
      clock_(std::move(clock)),
      id_(procman::sheriff_id_prefix()) {
  bus.subscribe<procman_lcm::deputy_info_t>(procman::kInfoChannel, [this](const auto& message) {
    on_info(procman::from_message(message));
  });
  bus.subscribe<procman_lcm::orders_t>(procman::kOrdersChannel, [this](const auto& message) {
    on_orders(procman::from_message(message));
  });
  bus.subscribe<procman_lcm::output_t>(procman::kOutputChannel, [this](const auto& message) {
    on_output(procman::from_message(message));
  });
}

void ProcessControl::on_info(const procman::DeputyInfo& info) {
  const bool is_ours = std::ranges::any_of(
      config_.commands, [&](const auto& command) { return command.deputy == info.deputy_id; });
  const time::Moment now = clock_();
  const bool is_taken = is_ours && deputies_.take(info, now.steady, bus_.origin().sender);
  if (is_taken && fleet_ && fleet_->take_info(info, now.steady)) {
    give_orders(now);
  }
}

void ProcessControl::on_orders(const procman::Orders& orders) {
  if (orders.sheriff_id.starts_with(id_) || deputies_.find(orders.deputy_id) == nullptr) {
    return;
  }
  const time::SteadyTime now = clock_().steady;
  other_sheriffs_.take(orders.sheriff_id, bus_.origin().sender, now);
  if (other_sheriffs_.running(now)) {
    fleet_.reset();  // it started later and will stay longer than we do
  }
}

// Keeps output of commands in the configuration only; invented names must not use memory.
void ProcessControl::on_output(const procman::Output& output) {
  for (const procman::CommandOutput& piece : output.outputs) {
    const procman::Command* command = config_.find_command(piece.command_id);
    if (command != nullptr && command->deputy == output.deputy_id) {
      consoles_[piece.command_id].take(piece.text);
    }
  }
}

Answer ProcessControl::output(const std::string& command) const {
  if (config_.find_command(command) == nullptr) {
    return no_such_command(command);
  }
  const auto console = consoles_.find(command);
  Answer answer{.ok = true, .text = ""};
  if (console != consoles_.end()) {
    for (const std::string& line : console->second.lines()) {
      answer.text += line + "\n";
    }
  }
  return answer;
}

void ProcessControl::begin(const time::Moment& now) {
  fleet_.emplace(config_, id_ + std::to_string(time::to_utime(now.wall)));
  fleet_->take_command(now.steady);
  open_.clear();
  for (const auto& [deputy, report] : deputies_.all()) {
    if (deputies_.is_reporting(deputy, now.steady)) {
      (void)fleet_->take_info(report->info, report->received);
    }
  }
}

Answer ProcessControl::change(Verb verb, const std::string& command) {
  const procman::Command* found = config_.find_command(command);
  if (found == nullptr) {
    return no_such_command(command);
  }
  const time::Moment now = clock_();
  if (const auto other = other_sheriffs_.received(now.steady)) {
    return {.ok = false, .text = "The sheriff " + *other + " is running: use that one."};
  }
  if (!deputies_.is_reporting(found->deputy, now.steady)) {
    return {.ok = false, .text = "The deputy " + found->deputy + " does not answer."};
  }
  if (!fleet_) {
    begin(now);
  }
  fleet_->order(verb, command);
  open_[command] = verb;
  leave_ = std::max(leave_, now.steady + kPatience + 1s * found->stop_time_allowed_s);
  give_orders(now);
  return {.ok = true, .text = command + ": " + procman::name_of(verb) + " asked."};
}

Answer ProcessControl::change_recording(Verb verb) {
  for (const procman::Command& command : config_.commands) {
    if (procman::program_of(command.exec) == node::kLogger) {
      return change(verb, command.id);
    }
  }
  return {.ok = false, .text = "The process configuration has no nodmap-logger."};
}

void ProcessControl::poll() {
  if (!fleet_) {
    return;
  }
  const time::Moment now = clock_();
  std::erase_if(open_, [&](const auto& wish) {
    const auto& [command, verb] = wish;
    return verb == Verb::kStop ? fleet_->is_stopped(command, now.steady)
                               : fleet_->is_running(command, now.steady);
  });
  if (open_.empty() || now.steady >= leave_) {
    procman::publish_discovery(bus_, *fleet_, now.wall);
    fleet_.reset();
    leave_ = {};
  } else if (now.steady >= orders_due_) {
    give_orders(now);
  }
}

void ProcessControl::give_orders(const time::Moment& now) {
  orders_due_ = now.steady + procman::kOrdersPeriod;
  procman::publish_orders(bus_, *fleet_, now.wall);
}

}  // namespace nodmap::viewer
