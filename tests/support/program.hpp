// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace nodmap::test {

struct ProgramResult {
  int exit_code = -1;  ///< 128 + signal when it was killed
  std::string out;     ///< stdout
  std::string err;     ///< stderr
};

/// Runs a program to its end. A name without a slash that begins with nodmap- is one of ours, as
/// just built; others are looked up in $PATH.
[[nodiscard]] ProgramResult run_program(const std::string& name,
                                        const std::vector<std::string>& arguments);

/// The content of a file; throws when it cannot be read.
[[nodiscard]] std::string slurp(const std::string& file);

}  // namespace nodmap::test
