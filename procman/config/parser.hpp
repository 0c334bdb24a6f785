// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "procman/config/config.hpp"

namespace nodmap::procman {

/// A configuration and its errors. Use it only if there are none.
struct ParsedConfig {
  Config config;
  std::vector<ConfigError> errors;
};

/// Parses the grammar of the existing procman tools (`host` and `deputy` mean the same) and our
/// `#nodmap:` comments. Never throws, whatever the text. Stops at the first syntax error; without
/// one it reports every unknown name in the scripts.
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

/// Formats an error for people and editors: FILE:LINE:COLUMN: text.
[[nodiscard]] std::string describe(const std::string& file, const ConfigError& error);

/// Reads a file. Throws formats::InputFileError if it cannot be opened, or with all its errors, one
/// per line.
[[nodiscard]] Config load_config(const std::filesystem::path& file);

}  // namespace nodmap::procman
