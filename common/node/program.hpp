// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "common/formats/user_error.hpp"
#include "common/params/params.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace nodmap::node {

/// Thrown when the user's command cannot be executed as given: a file is missing, or options
/// exclude each other.
class UsageError : public formats::UserError {
 public:
  using formats::UserError::UserError;
};

/// The name of a program and what it does, for --help.
struct ProgramInfo {
  std::string name;     ///< nodmap-slam2d
  std::string summary;  ///< one sentence
};

/// Describes a program for run_program(). A program without parameters or messages leaves `params`
/// or `uses_lcm` at their defaults; then it does not have the options for them.
struct Program {
  std::string name;                 ///< name of the executable: nodmap-slam2d
  std::string summary;              ///< one sentence for --help
  params::Table* params = nullptr;  ///< adds --config, --set, --dump-params and flags
  bool uses_lcm = false;            ///< adds --lcm-url
  std::string log_level = "info";   ///< default of --log-level
  /// Goes on when nobody reads its stdout and stderr any more, because it still has to save
  /// something or to stop a device. Other programs end then (SIGPIPE), as in `... | head`.
  bool outlives_its_readers = false;
  /// Only computes: SIGINT, SIGTERM and SIGHUP end it at once, as they end any program that has
  /// nothing to save. Other programs ask stop_requested() while they work.
  bool is_killed_by_signals = false;
  std::function<void(CLI::App&)> add_options = nullptr;  ///< its own options and subcommands
  /// Checks the combination of options and parameters before `run`. Throws UsageError.
  std::function<void()> check = nullptr;
  /// Does the work. The argument is the LCM URL as given ("" unless `uses_lcm`); returns the exit
  /// code.
  std::function<int(const std::string& lcm_url)> run;
};

/// main() of every program: reads the command line; loads --config, --set and flags into the
/// parameters, in this order; starts the log; makes SIGINT, SIGTERM and SIGHUP request the end,
/// unless `is_killed_by_signals`; and calls `run`. Returns the exit code: 2 for a wrong command
/// line or configuration, or a formats::UserError of `run`, and 1 for any other exception of it,
/// each after one line on stderr; 0 after --help and --version; otherwise the result of `run`. 0
/// becomes 1, after a line on stderr, if stdout cannot be written.
int run_program(int argc, char** argv, const Program& program);

/// Makes SIGINT, SIGTERM and SIGHUP request the end of the process instead of killing it; SIGHUP
/// only if it was not ignored (nohup). run_program() calls this before `run`.
void catch_stop_signals();

/// Whether one of these signals has been received.
[[nodiscard]] bool stop_requested();

}  // namespace nodmap::node
