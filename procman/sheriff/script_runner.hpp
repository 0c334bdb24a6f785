// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/geometry/time.hpp"
#include "procman/config/config.hpp"
#include "procman/protocol/fleet.hpp"

namespace nodmap::procman {

/// Starts, stops or restarts all commands of a target.
void give_order(Fleet& fleet, const Config& config, Verb verb, const Target& target);

/// Runs a script of a configuration, action by action. A wait has no timeout, as in the existing
/// tools. But the script fails when what it waits for cannot happen any more, and when a command
/// that it has started does not keep running.
class ScriptRunner {
 public:
  /// A command that has run for this long counts as started.
  static constexpr time::Duration kLastingTime = 1s;
  /// The longest wait for that, after the last action. A deputy may refuse orders for 3 s after the
  /// sheriff before has been killed.
  static constexpr time::Duration kSettleTimeout = 8s;

  using HealthTest = std::function<bool(const std::string& command)>;

  /// Configuration and script must outlive the runner. The script must not run itself
  /// (check_scripts()). `is_healthy` is called for running commands when the script waits for
  /// "healthy".
  ScriptRunner(const Config& config, const Script& script, HealthTest is_healthy);

  /// Executes all actions that are possible now. To be called repeatedly until is_over().
  void step(Fleet& fleet, time::SteadyTime now);
  /// Whether the script is done or has failed.
  [[nodiscard]] bool is_over() const { return is_settled_ || !failure_.empty(); }
  /// Why it has failed: which commands have ended, and how. Empty if it has not failed.
  [[nodiscard]] const std::string& failure() const { return failure_; }
  /// What it is waiting for, as text for people.
  [[nodiscard]] std::string waiting_for() const;

 private:
  void append(const Script& script);
  [[nodiscard]] bool try_to_finish(const Action& action, const Fleet& fleet, time::SteadyTime now);
  void note_order(const Order& order);
  [[nodiscard]] std::string dead_commands(const Target& target, const Fleet& fleet,
                                          time::SteadyTime now) const;
  void settle(const Fleet& fleet, time::SteadyTime now);

  [[nodiscard]] bool has_arrived(const WaitFor& wait, const Fleet& fleet,
                                 time::SteadyTime now) const;

  const Config& config_;
  HealthTest is_healthy_;
  std::vector<const Action*> actions_;  // including those of called scripts, in order
  std::size_t at_ = 0;
  bool has_begun_ = false;  // the action at at_ has been executed; its wait is not over
  time::SteadyTime begin_{};
  std::set<std::string> started_;  // commands that must run after the script
  std::optional<time::SteadyTime> done_;
  bool is_settled_ = false;
  std::string failure_;
};

}  // namespace nodmap::procman
