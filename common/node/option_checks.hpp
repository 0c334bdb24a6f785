// SPDX-License-Identifier: BSD-3-Clause
// Checks for CLI::Option::check(). Those of CLI11 name the largest number in their errors, with its
// 309 digits.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace nodmap::node {

[[nodiscard]] inline CLI::Validator at_least_zero() {
  return {[](const std::string& text) {
            double value = 0.0;
            return CLI::detail::lexical_cast(text, value) && value >= 0.0
                       ? std::string()
                       : "'" + text + "' is not a number of 0 or more";
          },
          "NONNEGATIVE"};
}

[[nodiscard]] inline CLI::Validator above_zero() {
  return {[](const std::string& text) {
            double value = 0.0;
            return CLI::detail::lexical_cast(text, value) && value > 0.0
                       ? std::string()
                       : "'" + text + "' is not a number above 0";
          },
          "POSITIVE"};
}

}  // namespace nodmap::node
