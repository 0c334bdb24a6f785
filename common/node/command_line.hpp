// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/params/params.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace nodmap::node {

/// The options every process has (interfaces: "Every process").
struct CommonOptions {
  std::string lcm_url;
  std::vector<std::string> configs;
  std::vector<std::string> assignments;
  std::string log_level = "info";
  bool dump_params = false;
  bool params_markdown = false;
  std::vector<std::string> flags_given;
};

/// Adds the common options, and a flag for each flag parameter.
void add_common_options(CLI::App& app, CommonOptions& options, const params::Table& table);

/// Parses. An exit code when there is nothing left to do: 0 after --help or --version, 2 after an
/// error, which has been printed as one line.
[[nodiscard]] std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv);

/// Loads configuration, --set and flags into the table, in this order, and starts the logger.
/// Prints parameters where asked. An exit code as for parse_command_line().
[[nodiscard]] std::optional<int> apply_common_options(const std::string& program,
                                                      const CommonOptions& options,
                                                      params::Table& table);

/// Makes an empty folder for results. Throws std::runtime_error when it exists and is not empty:
/// results are never overwritten.
void make_result_dir(const std::filesystem::path& dir);

/// The same for a live process, which may be started anew beside its former results: where there
/// are some, the first of DIR.2, DIR.3, ... without any is made and returned instead. No name, no
/// folder.
[[nodiscard]] std::filesystem::path make_next_result_dir(const std::filesystem::path& dir);

}  // namespace nodmap::node
