// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace nodmap::procman {

/// A position in a file: line and column (in bytes), counted from 1.
struct Place {
  int line = 1;
  int column = 1;
};

/// When a running command is restarted because of its STATUS or its silence. An extension: written
/// in comments that begin with `#nodmap:`, which the existing tools skip.
struct HealthRule {
  std::string status_name;                ///< process_name in STATUS; empty: the exec's program
  std::optional<int> restart_silent_s;    ///< after this long without a STATUS
  std::optional<int> restart_failed_s;    ///< after being FAILED for this long
  std::optional<int> restart_degraded_s;  ///< after being DEGRADED or FAILED for this long
  std::optional<int> restart_mute_s;      ///< after this long without output (stdout, stderr)
};

/// The resources of the host that a command may use. An extension, like the health rules.
struct Resources {
  int nice = 0;           ///< 1 to 19: lower priority than ordinary processes
  int realtime = 0;       ///< 1 to 99: real-time priority (SCHED_RR)
  int memory_mb = 0;      ///< limit of the memory of each of its processes; 0: none
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

/// The commands to which an action applies.
struct Target {
  TargetKind kind = TargetKind::kEverything;
  std::string name;  ///< name of the command, or path of the group
};

/// The state that a script waits for. Healthy means running, and OK in the newest STATUS; it is an
/// extension.
enum class Wanted : std::uint8_t { kRunning, kStopped, kHealthy };
enum class Verb : std::uint8_t { kStart, kStop, kRestart };

[[nodiscard]] const char* name_of(Verb verb);  ///< start, stop, restart

struct Order {
  Verb verb = Verb::kStart;
  Target target;
  std::optional<Wanted> wait;
};
struct Pause {
  std::int64_t duration_ms = 0;
};
struct WaitFor {
  Target target;
  Wanted status = Wanted::kRunning;
};
struct RunScript {
  std::string name;
};

struct Action {
  std::variant<Order, Pause, WaitFor, RunScript> what;
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
  std::vector<std::string> groups;  ///< paths, including those of groups that contain only groups
  std::vector<Script> scripts;

  [[nodiscard]] const Command* find_command(std::string_view id) const;
  [[nodiscard]] const Script* find_script(std::string_view name) const;
  [[nodiscard]] bool has_group(std::string_view path) const;

  /// The commands of a target; for a group also those of its subgroups.
  [[nodiscard]] std::vector<const Command*> commands_of(const Target& target) const;
};

/// The path of a group without leading, trailing and doubled slashes.
[[nodiscard]] std::string normalized_group(std::string_view path);

/// Whether `group` is `ancestor` or below it.
[[nodiscard]] bool is_in_group(std::string_view group, std::string_view ancestor);

/// The name under which a command's process publishes STATUS.
[[nodiscard]] std::string status_name(const Command& command);

struct ConfigError {
  Place place;
  std::string text;
};

/// Checks the scripts of a configuration: returns an error for each name that does not exist, and
/// for each script that runs itself.
[[nodiscard]] std::vector<ConfigError> check_scripts(const Config& config);

}  // namespace nodmap::procman
