// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "procman/config/config.hpp"
#include "procman/sheriff/fleet.hpp"

namespace nodmap::procman {

/// Starts, stops or restarts one command.
void give_order(Fleet& fleet, Verb verb, const std::string& id);

/// Carries a target's order out on a fleet.
void give_order(Fleet& fleet, const Config& config, Verb verb, const Target& target);

/// Whether all that a target means has reached a status.
[[nodiscard]] bool has_reached(const Fleet& fleet, const Config& config, const Target& target,
                               Wanted wanted, std::int64_t now_us);

/// Runs a script of a configuration, action by action. As in the existing tools a wait has no end
/// of its own.
class ScriptRunner {
 public:
  /// Both must outlive the runner; the script's calls are known to end (check_scripts()).
  ScriptRunner(const Config& config, const Script& script);

  /// Does what can be done by now. To be called again and again until done().
  void step(Fleet& fleet, std::int64_t now_us);
  [[nodiscard]] bool done() const { return at_ == actions_.size(); }
  /// What it waits for, for people.
  [[nodiscard]] std::string waiting_for() const;

 private:
  void append(const Script& script);
  [[nodiscard]] bool is_over(const Fleet& fleet, std::int64_t now_us) const;

  const Config& config_;
  std::vector<const Action*> actions_;  // with those of called scripts in their places
  std::size_t at_ = 0;
  bool begun_ = false;  // the action at at_ has been given, and is waited for
  std::int64_t begun_us_ = 0;
};

}  // namespace nodmap::procman
