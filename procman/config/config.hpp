// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace nodmap::procman {

/// Where in a file, both counted from 1; a column is a byte.
struct Place {
  int line = 1;
  int column = 1;
};

/// When a command that runs is to be restarted for what it says in STATUS. The extension of our
/// tools: written in comments that begin with `#nodmap:`, which the existing tools skip.
struct HealthRule {
  std::string status_name;                ///< process_name in STATUS; empty: the exec's program
  std::optional<int> restart_silent_s;    ///< after so long without a STATUS
  std::optional<int> restart_failed_s;    ///< after being FAILED for so long
  std::optional<int> restart_degraded_s;  ///< after being DEGRADED or FAILED for so long
  std::optional<int> restart_mute_s;      ///< after writing nothing (stdout, stderr) for so long
};

/// What of the host a command may take. An extension of our tools, as the health rules.
struct Resources {
  int nice = 0;           ///< 1 to 19: gives way to all others
  int realtime = 0;       ///< 1 to 99: goes before all others (SCHED_RR)
  int memory_mb = 0;      ///< most that each of its processes may allocate; 0: no limit
  std::vector<int> cpus;  ///< the processors it may run on, from 0; empty: all
};

/// One command of the configuration.
struct Command {
  static constexpr int kDefaultStopSignal = 2;  // SIGINT
  static constexpr int kDefaultStopTimeS = 7;

  std::string id;
  std::string exec;
  std::string deputy = "localhost";
  std::string group;  ///< path, "outer/inner"; empty at the top
  bool auto_respawn = false;
  int stop_signal = kDefaultStopSignal;
  int stop_time_allowed_s = kDefaultStopTimeS;
  HealthRule health;
  Resources resources;
  Place place;
};

enum class TargetKind : std::uint8_t { kEverything, kCommand, kGroup };

/// What an action is about.
struct Target {
  TargetKind kind = TargetKind::kEverything;
  std::string name;  ///< of the command, or path of the group
};

/// Healthy: running, and the newest STATUS of its process is OK. An extension of our tools.
enum class Wanted : std::uint8_t { kRunning, kStopped, kHealthy };
enum class Verb : std::uint8_t { kStart, kStop, kRestart };

struct Order {
  Verb verb = Verb::kStart;
  Target target;
  std::optional<Wanted> wait;
};
struct WaitTime {
  std::int64_t duration_ms = 0;
};
struct WaitStatus {
  Target target;
  Wanted status = Wanted::kRunning;
};
struct RunScript {
  std::string name;
};

struct Action {
  std::variant<Order, WaitTime, WaitStatus, RunScript> what;
  Place place;
};

struct Script {
  std::string name;
  std::vector<Action> actions;
  Place place;
};

/// A whole configuration, in the order of the file.
struct Config {
  std::vector<Command> commands;
  std::vector<std::string> groups;  ///< paths, also of those that hold groups only
  std::vector<Script> scripts;

  [[nodiscard]] const Command* find_command(std::string_view id) const;
  [[nodiscard]] const Script* find_script(std::string_view name) const;
  [[nodiscard]] bool has_group(std::string_view path) const;

  /// The commands a target means: of a group those of its subgroups, too.
  [[nodiscard]] std::vector<const Command*> commands_of(const Target& target) const;
};

/// The path of a group without leading, trailing and doubled slashes.
[[nodiscard]] std::string normalized_group(std::string_view path);

/// Whether `group` is `ancestor` or below it.
[[nodiscard]] bool is_in_group(std::string_view group, std::string_view ancestor);

/// The name of the program that an exec line runs, without its folder: the first word that sets no
/// variable. Empty where there is none.
[[nodiscard]] std::string program_of(std::string_view exec);

/// The name under which a command's process publishes STATUS.
[[nodiscard]] std::string status_name(const Command& command);

struct ConfigError {
  Place place;
  std::string text;
};

/// What the scripts of a configuration name that is not there, and scripts that run themselves.
[[nodiscard]] std::vector<ConfigError> check_scripts(const Config& config);

}  // namespace nodmap::procman
