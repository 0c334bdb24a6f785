// SPDX-License-Identifier: BSD-3-Clause
// What nodmap-sheriff can be asked for, each as a function that returns the exit code.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "procman/config/config.hpp"
#include "procman/sheriff/sheriff.hpp"

namespace nodmap::procman {

enum ExitCode : int {
  kDone = 0,
  kFailed = 1,        ///< not reached, or a host that does not answer
  kWrong = 2,         ///< command line or configuration
  kOtherSheriff = 3,  ///< another sheriff gives orders here
};

/// How long deputies are given to answer: they do so at once, and anyway each second.
inline constexpr std::chrono::milliseconds kAnswerTime{2500};

/// So long a sheriff listens for another before it commands: longer than its orders are apart.
inline constexpr std::chrono::milliseconds kSheriffTime{1300};

/// Prints what the configuration holds.
int print_config(const std::string& file, const Config& config);

/// Prints how everything is, once. kFailed when a host of the configuration does not answer.
int print_status(Sheriff& sheriff, bool as_json);

/// Starts, stops or restarts a command or group, and waits until that is so.
int change(Sheriff& sheriff, Verb verb, const std::string& name);

/// Prints what a command writes, until interrupted.
int follow_output(Sheriff& sheriff, const std::string& command);

enum class AfterScript : std::uint8_t { kExit, kStay, kObserve };

struct WatchOptions {
  const Script* script = nullptr;  ///< none: only watch
  AfterScript after_script = AfterScript::kStay;
  std::optional<double> timeout_s;  ///< for the script
  bool observe = false;             ///< look only, give no orders
  std::string config_file;          ///< read anew whenever it was edited
};

/// Runs a script and applies the health rules: in the live view on a terminal, else with a line on
/// stdout for each change.
int watch(Sheriff& sheriff, const WatchOptions& options);

}  // namespace nodmap::procman
