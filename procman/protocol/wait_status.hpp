// SPDX-License-Identifier: BSD-3-Clause
// How a process has ended, from its wait status as waitpid() reports it.
#pragma once

#include <string>

namespace nodmap::procman {

/// Describes an end: "exit 3", "killed by signal 9 (Killed)"; empty for exit code 0.
[[nodiscard]] std::string describe_end(int wait_status);

/// Whether a command may have ended because it was stopped: with exit code 0, or by its stop
/// signal, or by one of those that end what does not obey it. Any other end is an error.
[[nodiscard]] bool may_be_a_stop(int wait_status, int stop_signal);

}  // namespace nodmap::procman
