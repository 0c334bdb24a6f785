// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace nodmap::test {

struct ProgramResult {
  int exit_code = -1;  ///< 128 + signal if it was killed
  std::string out;     ///< stdout
  std::string err;     ///< stderr
};

/// Runs a program and waits for its end. A name that begins with nodmap- and has no slash is a
/// program of this build; others are looked up in $PATH.
[[nodiscard]] ProgramResult run_program(const std::string& name,
                                        const std::vector<std::string>& arguments);

/// Reads a whole file. Throws std::runtime_error if it cannot be read.
[[nodiscard]] std::string slurp(const std::string& file);

}  // namespace nodmap::test
