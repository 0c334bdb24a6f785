// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace nodmap::params {

/// Returns "; did you mean 'X'?" for an unknown word. X is the known word with the fewest typing
/// errors (letter added, missing, replaced, or two swapped), at most one per three letters. Empty
/// if no known word is that similar. For a nested name (matcher.max_iterations) the last part is
/// sufficient.
[[nodiscard]] std::string did_you_mean(std::string_view word,
                                       const std::vector<std::string>& known);

}  // namespace nodmap::params
