// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace nodmap::params {

/// For a word that is unknown: "; did you mean 'X'?" with the known word that is the fewest typing
/// errors away (a letter more, less, another one, or two swapped), at most one in three letters.
/// Empty where none is that near. Of a nested name, matcher.max_iterations, the last part is
/// enough.
[[nodiscard]] std::string did_you_mean(std::string_view word,
                                       const std::vector<std::string>& known);

}  // namespace nodmap::params
