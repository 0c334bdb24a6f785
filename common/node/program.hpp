// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

#include "common/params/params.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace nodmap::node {

/// What the user asked for cannot be done as given: a file that is missing, options that exclude
/// each other. run_program() prints it and returns 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a program is, for run_program(). A program that has no parameters and sends no messages
/// leaves `params` and `uses_lcm` as they are: it then has none of the options for them.
struct Program {
  std::string name;                 ///< as the file: nodmap-slam2d
  std::string summary;              ///< one sentence for --help
  params::Table* params = nullptr;  ///< adds --config, --set, --dump-params and flags
  bool uses_lcm = false;            ///< adds --lcm-url
  std::string log_level = "info";   ///< default of --log-level
  std::function<void(CLI::App&)> add_options = nullptr;  ///< its own options and subcommands
  /// Checks what options and parameters mean together, before the work. Throws UsageError.
  std::function<void()> check = nullptr;
  /// The work. Takes the LCM URL as given ("" unless `uses_lcm`); returns the exit code.
  std::function<int(const std::string& lcm_url)> run;
};

/// main() of every program: reads the command line, loads --config, --set and flags into the
/// parameters in this order, starts the log, lets SIGINT and SIGTERM ask for the end, and runs.
/// Returns the exit code: 2 for a wrong command line or configuration, for a UsageError and for a
/// formats::InputFileError, 1 for
/// another exception out of `run`, each after one line on stderr; 0 after --help and --version;
/// else what `run` returned.
int run_program(int argc, char** argv, const Program& program);

/// From now on SIGINT and SIGTERM ask the process to stop instead of killing it. run_program() has
/// called this before `run`.
void catch_stop_signals();

/// Whether SIGINT or SIGTERM has come.
[[nodiscard]] bool stop_requested();

}  // namespace nodmap::node
