// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/tasks.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>

#include "common/node/log.hpp"
#include "common/node/program.hpp"
#include "common/params/suggestion.hpp"
#include "procman/sheriff/output_follower.hpp"
#include "procman/sheriff/printable.hpp"
#include "procman/sheriff/script_runner.hpp"

namespace nodmap::procman {
namespace {

constexpr std::chrono::milliseconds kWait = 50ms;
constexpr time::Duration kLookingTime = 1300ms;
constexpr time::Duration kStartTime = 10s;
// A command that ends sooner does not count as started.
constexpr time::Duration kSettleTime = 500ms;

// Waits for INFO of all these deputies. Returns those from which none came in time.
std::vector<std::string> missing_deputies(Sheriff& sheriff, const std::set<std::string>& wanted) {
  const time::SteadyTime deadline = Sheriff::now() + kAnswerTime;
  std::vector<std::string> missing;
  do {
    sheriff.work(kWait);
    missing.clear();
    for (const std::string& id : wanted) {
      if (!sheriff.fleet().deputies().is_reporting(id, Sheriff::now())) {
        missing.push_back(id);
      }
    }
  } while (!missing.empty() && Sheriff::now() < deadline && !node::stop_requested());
  for (const std::string& id : missing) {
    std::cerr << "nodmap-sheriff: the deputy " << printable(id) << " does not answer\n";
  }
  return missing;
}

std::set<std::string> deputies_of(const std::vector<const Command*>& commands) {
  std::set<std::string> all;
  for (const Command* command : commands) {
    all.insert(command->deputy);
  }
  return all;
}

std::vector<std::string> command_names(const Config& config) {
  std::vector<std::string> names;
  for (const Command& command : config.commands) {
    names.push_back(command.id);
  }
  return names;
}

// Listens for other sheriffs; returns whether none gives orders. Two sheriffs would give
// contradictory orders, so the second one ends.
bool wait_to_be_alone(Sheriff& sheriff) {
  const time::SteadyTime begin = Sheriff::now();
  while (is_looking_for_others(sheriff.fleet(), begin, Sheriff::now()) && !node::stop_requested()) {
    sheriff.work(kWait);
    if (const auto other = sheriff.fleet().other_sheriffs().running(Sheriff::now())) {
      std::cerr << "nodmap-sheriff: the sheriff " << printable(*other)
                << " gives orders here already (use that one, or --observe)\n";
      return false;
    }
  }
  return true;
}

// How long a change may take: a start some seconds, a stop also its grace time.
time::Duration patience(Verb verb, const std::vector<const Command*>& commands) {
  time::Duration stop_time{};
  if (verb != Verb::kStart) {
    for (const Command* command : commands) {
      stop_time = std::max<time::Duration>(stop_time, 1s * command->stop_time_allowed_s);
    }
  }
  return kStartTime + stop_time;
}

// Whether nothing more will happen: the command has run for kSettleTime, or has ended, well or
// not.
bool is_settled(const Fleet& fleet, const Command& command, Verb verb) {
  const time::SteadyTime now = Sheriff::now();
  const CommandState state = fleet.state_of(command.id, now);
  if (verb == Verb::kStop) {
    return fleet.is_stopped(command.id, now);
  }
  const bool has_lasted = now - fleet.find(command.id)->running_since >= kSettleTime;
  return (state == CommandState::kRunning && has_lasted) || state == CommandState::kStoppedOk ||
         state == CommandState::kStoppedError;
}

// Whether the verb has succeeded. A started command that has ended without error counts as well.
bool is_as_wanted(const Fleet& fleet, const Command& command, Verb verb) {
  const CommandState state = fleet.state_of(command.id, Sheriff::now());
  return verb == Verb::kStop ? is_settled(fleet, command, verb)
                             : state == CommandState::kRunning || state == CommandState::kStoppedOk;
}

// The health rules and resources of a command, as they were read: a comment that is almost an
// extension is none.
std::string extensions_of(const Command& command) {
  std::string text;
  const auto add = [&text](const char* name, const std::optional<int>& value) {
    text += value ? std::string(" ") + name + " = " + std::to_string(*value) + ";" : "";
  };
  const auto add_if_set = [&add](const char* name, int value) {
    add(name, value != 0 ? std::optional(value) : std::nullopt);
  };
  const HealthRule& health = command.health;
  text += health.status_name.empty() ? "" : " status_name = \"" + health.status_name + "\";";
  add("restart_silent_s", health.restart_silent_s);
  add("restart_failed_s", health.restart_failed_s);
  add("restart_degraded_s", health.restart_degraded_s);
  add("restart_mute_s", health.restart_mute_s);
  add_if_set("nice", command.resources.nice);
  add_if_set("realtime", command.resources.realtime);
  add_if_set("memory_mb", command.resources.memory_mb);
  std::string cpus;
  for (const int cpu : command.resources.cpus) {
    cpus += (cpus.empty() ? "" : ",") + std::to_string(cpu);
  }
  text += cpus.empty() ? "" : " cpus = \"" + cpus + "\";";
  return text;
}

}  // namespace

bool is_looking_for_others(const Fleet& fleet, time::SteadyTime begin, time::SteadyTime now) {
  return now - begin < (fleet.other_sheriffs().received(now) ? 2 : 1) * kLookingTime;
}

int print_config(const std::string& file, const Config& config) {
  std::printf("%s: %zu commands, %zu groups, %zu scripts\n", file.c_str(), config.commands.size(),
              config.groups.size(), config.scripts.size());
  for (const Command& command : config.commands) {
    std::printf("command %s%s%s on %s: %s\n", command.group.c_str(),
                command.group.empty() ? "" : "/", command.id.c_str(), command.deputy.c_str(),
                command.exec.c_str());
    if (const std::string extensions = extensions_of(command); !extensions.empty()) {
      std::printf("    #nodmap:%s\n", extensions.c_str());
    }
  }
  for (const std::string& group : config.groups) {
    std::printf("group %s: %zu commands\n", group.c_str(),
                config.commands_of({TargetKind::kGroup, group}).size());
  }
  for (const Script& script : config.scripts) {
    std::printf("script %s: %zu actions\n", script.name.c_str(), script.actions.size());
  }
  return exit_code::kDone;
}

int print_status(Sheriff& sheriff, bool as_json) {
  const auto missing = missing_deputies(sheriff, deputies_of(sheriff.config().commands_of({})));
  // STATUS and another sheriff's orders are published once a second.
  const time::SteadyTime begin = Sheriff::now();
  while (is_looking_for_others(sheriff.fleet(), begin, Sheriff::now()) && !node::stop_requested()) {
    sheriff.work(kWait);
  }
  const std::vector<ReportRow> rows = sheriff.report();
  if (as_json) {
    std::cout << to_json(rows, sheriff.warnings(), sheriff.fleet(), Sheriff::now())
                     .dump(2, ' ', false, nlohmann::json::error_handler_t::replace)
              << "\n";
  } else {
    for (const std::string& line : to_table(rows)) {
      std::cout << line << "\n";
    }
    for (const std::string& warning : sheriff.warnings()) {
      std::cout << printable(warning) << "\n";
    }
  }
  return missing.empty() ? exit_code::kDone : exit_code::kFailed;
}

int change(Sheriff& sheriff, Verb verb, const std::string& name) {
  const Config& config = sheriff.config();
  const bool is_command = config.find_command(name) != nullptr;
  if (!is_command && !config.has_group(name)) {
    std::vector<std::string> names = command_names(config);
    names.insert(names.end(), config.groups.begin(), config.groups.end());
    std::cerr << "nodmap-sheriff: there is no command and no group \"" << name << "\""
              << params::did_you_mean(name, names) << "\n";
    return exit_code::kWrong;
  }
  const Target target{is_command ? TargetKind::kCommand : TargetKind::kGroup, name};
  const auto commands = config.commands_of(target);
  if (!wait_to_be_alone(sheriff)) {
    return exit_code::kOtherSheriff;
  }
  if (!missing_deputies(sheriff, deputies_of(commands)).empty()) {
    return exit_code::kFailed;
  }
  sheriff.take_command();
  give_order(sheriff.fleet(), config, verb, target);
  sheriff.give_orders();
  const time::SteadyTime deadline = Sheriff::now() + patience(verb, commands);
  const auto all_settled = [&] {
    return std::ranges::all_of(commands, [&](const Command* command) {
      return is_settled(sheriff.fleet(), *command, verb);
    });
  };
  while (!all_settled() && Sheriff::now() < deadline && !node::stop_requested()) {
    sheriff.work(kWait);
  }
  int code = exit_code::kDone;
  for (const Command* command : commands) {
    const bool is_good = is_as_wanted(sheriff.fleet(), *command, verb);
    code = is_good ? code : exit_code::kFailed;
    std::cout << command->id << ": "
              << name_of(sheriff.fleet().state_of(command->id, Sheriff::now())) << "\n";
  }
  return code;
}

int follow_output(Sheriff& sheriff, const std::string& command) {
  const Command* known = sheriff.config().find_command(command);
  if (known == nullptr) {
    std::cerr << "nodmap-sheriff: there is no command \"" << command << "\""
              << params::did_you_mean(command, command_names(sheriff.config())) << "\n";
    return exit_code::kWrong;
  }
  OutputFollower follower(::isatty(STDOUT_FILENO) != 0);
  const auto print = [](const std::string& text) { std::cout << text << std::flush; };
  sheriff.on_output([&](const std::string& id, const std::string& text) {
    print(id == command ? follower.take(text) : "");
  });
  sheriff.on_last_output([&](const std::string& id, const std::string& text) {
    print(id == command ? follower.take_last(text) : "");
  });
  if (!missing_deputies(sheriff, {known->deputy}).empty()) {
    return exit_code::kFailed;
  }
  const time::SteadyTime answered = Sheriff::now();
  while (!node::stop_requested() && std::cout) {
    sheriff.work(kWait);
    print(Sheriff::now() - answered > kAnswerTime ? follower.stop_waiting() : "");
  }
  return exit_code::kDone;
}

}  // namespace nodmap::procman
