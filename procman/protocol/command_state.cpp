// SPDX-License-Identifier: BSD-3-Clause
#include "procman/protocol/command_state.hpp"

namespace nodmap::procman {

const char* short_name_of(CommandState state) {
  switch (state) {
    case CommandState::kStarting:
      return "Starting";
    case CommandState::kRunning:
      return "Running";
    case CommandState::kRestarting:
      return "Restarting";
    case CommandState::kStopping:
      return "Stopping";
    case CommandState::kStoppedOk:
      return "Stopped (OK)";
    case CommandState::kStoppedError:
      return "Stopped (Error)";
    default:
      return "Unknown";
  }
}

std::string name_of(CommandState state) {
  const bool is_ordered = state == CommandState::kStarting || state == CommandState::kRestarting ||
                          state == CommandState::kStopping;
  return std::string(short_name_of(state)) + (is_ordered ? " (Command Sent)" : "");
}

}  // namespace nodmap::procman
