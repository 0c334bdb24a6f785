// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace nodmap::procman {

/// The parts of an exec line: `NAME=VALUE ... program arguments ...`.
struct ExecLine {
  std::vector<std::pair<std::string, std::string>> environment;
  std::vector<std::string> arguments;  ///< the program first; empty if the line has none
};

/// Splits an exec line as the existing deputy does, without a shell. Words are separated by blanks;
/// '...' and "..." may contain blanks; a backslash quotes the next character.
[[nodiscard]] ExecLine split_exec_line(std::string_view line);

/// The program that an exec line runs, without its folder. Empty if there is none.
[[nodiscard]] std::string program_of(std::string_view exec);

}  // namespace nodmap::procman
