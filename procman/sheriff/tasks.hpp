// SPDX-License-Identifier: BSD-3-Clause
// The tasks of nodmap-sheriff, each a function that returns the exit code.
#pragma once

#include <chrono>
#include <string>

#include "procman/config/config.hpp"
#include "procman/sheriff/sheriff.hpp"

namespace nodmap::procman {

namespace exit_code {
inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;        ///< not reached, or a host does not answer
inline constexpr int kWrong = 2;         ///< command line or configuration
inline constexpr int kOtherSheriff = 3;  ///< another sheriff gives orders here
}  // namespace exit_code

/// The longest wait for deputies. They answer at once, and publish INFO every second anyway.
inline constexpr time::Duration kAnswerTime = 2500ms;

/// Whether a sheriff that started at `begin` still looks for others before it gives orders: for
/// longer than the period at which they send theirs, and for as long again if it has received any,
/// to know whether they are repeated.
[[nodiscard]] bool is_looking_for_others(const Fleet& fleet, time::SteadyTime begin,
                                         time::SteadyTime now);

/// Prints the content of the configuration.
int print_config(const std::string& file, const Config& config);

/// Prints the state of everything once. exit_code::kFailed if a host of the configuration does not
/// answer.
int print_status(Sheriff& sheriff, bool as_json);

/// Starts, stops or restarts a command or group, and waits until this has happened.
int change(Sheriff& sheriff, Verb verb, const std::string& name);

/// Prints the last output of a command, and what follows until interrupted; without colours if
/// stdout is no terminal. exit_code::kFailed if its deputy does not answer.
int follow_output(Sheriff& sheriff, const std::string& command);

}  // namespace nodmap::procman
