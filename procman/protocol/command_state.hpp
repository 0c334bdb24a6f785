// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace nodmap::procman {

enum class CommandState : std::uint8_t {
  kUnknown,  ///< no INFO of its deputy was received, or not recently
  kStarting,
  kRunning,
  kRestarting,
  kStopping,
  kStoppedOk,
  kStoppedError,
};

/// The text for people: "Running", "Starting", "Stopped (Error)", ...
[[nodiscard]] const char* short_name_of(CommandState state);
/// The same as in the existing sheriff: "Starting (Command Sent)" while a deputy carries out
/// orders.
[[nodiscard]] std::string name_of(CommandState state);

}  // namespace nodmap::procman
