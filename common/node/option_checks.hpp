// SPDX-License-Identifier: BSD-3-Clause
// Checks for CLI::Option::check(). Those of CLI11 name the largest number in their errors, with its
// 309 digits, and the limits of a range with six decimals.
#pragma once

#include <CLI/CLI.hpp>
#include <sstream>
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

[[nodiscard]] inline CLI::Validator in_range(double min, double max) {
  std::ostringstream name;  // without spaces, by which a man page tells it from the option's text
  name << min << ".." << max;
  return {[min, max](const std::string& text) {
            double value = 0.0;
            if (CLI::detail::lexical_cast(text, value) && value >= min && value <= max) {
              return std::string();
            }
            std::ostringstream error;
            error << "'" << text << "' is not a number from " << min << " to " << max;
            return error.str();
          },
          name.str()};
}

}  // namespace nodmap::node
