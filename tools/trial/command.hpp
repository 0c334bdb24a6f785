// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "common/formats/user_error.hpp"
#include "tools/trial/trial.hpp"

namespace nodmap::trial {

/// Thrown for an invalid command line; what() is one line.
class CommandError : public formats::UserError {
 public:
  using formats::UserError::UserError;
};

/// Throws CommandError, with a text that begins with `source`, for an unknown process.
void check_process(std::string_view process, const std::string& source);

/// Parses "PROCESS@T+D", seconds. Throws CommandError.
[[nodiscard]] Kill parse_kill(const std::string& text);

/// Throws CommandError if a process is to be killed that does not run.
void check_kills(const TrialSetup& setup);

}  // namespace nodmap::trial
