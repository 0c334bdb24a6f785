// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "procman/config/config.hpp"

namespace nodmap::procman {

/// A configuration, and what is wrong with it: it is to be used only when there are no errors.
struct ParsedConfig {
  Config config;
  std::vector<ConfigError> errors;
};

/// Reads the grammar of the existing procman tools (`host` and `deputy` mean the same), and the
/// `#nodmap:` comments that are ours. Never throws on text. Syntax ends at its first error; the
/// references of scripts are all checked.
///
///     config  = { command | group | script }
///     command = "cmd" [ STRING ] "{" { attribute "=" ( STRING | INTEGER ) ";" } "}"
///     group   = "group" STRING "{" { command | group } "}"
///     script  = "script" STRING "{" { action ";" } "}"
///     action  = ("start" | "stop" | "restart") target [ "wait" ("running" | "stopped") ]
///             | "wait" "ms" INTEGER
///             | "wait" ("cmd" | "group") STRING "status" ("running" | "stopped")
///             | "run_script" STRING
///             | "wait" ("cmd" | "group") STRING "status" "healthy"      in a `#nodmap:` comment
///     target  = "everything" | ("cmd" | "group") STRING
[[nodiscard]] ParsedConfig parse_config(std::string_view text);

/// The error as people and editors read it: FILE:LINE:COLUMN: text.
[[nodiscard]] std::string describe(const std::string& file, const ConfigError& error);

/// Reads a file. Throws formats::InputFileError when it cannot be opened; std::runtime_error with
/// all errors in it, a line for each.
[[nodiscard]] Config load_config(const std::filesystem::path& file);

}  // namespace nodmap::procman
