// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace nodmap::procman {

/// What an exec line asks for: `NAME=VALUE ... program arguments ...`.
struct ExecLine {
  std::vector<std::pair<std::string, std::string>> environment;
  std::vector<std::string> arguments;  ///< the program first; empty when the line names none
};

/// Looks up an environment variable; nothing when it is not set.
using Lookup = std::function<std::optional<std::string>(const std::string& name)>;

/// Takes an exec line apart as the existing deputy does, without a shell: words between blanks,
/// '...' and "..." hold blanks, a backslash takes the next character as it is; then $NAME and
/// ${NAME} in the program's words are replaced by the deputy's variables, and those that are not
/// set stay as typed.
[[nodiscard]] ExecLine parse_exec_line(std::string_view line, const Lookup& lookup);

}  // namespace nodmap::procman
