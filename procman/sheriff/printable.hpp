// SPDX-License-Identifier: BSD-3-Clause
// Text that is safe for a terminal, and its width there.
#pragma once

#include <cstddef>
#include <string>

namespace nodmap::procman {

/// Makes text safe for a terminal: control characters and invalid UTF-8 become '?'.
[[nodiscard]] std::string printable(const std::string& text);

/// The number of characters of a printable text.
[[nodiscard]] std::size_t width_of(const std::string& text);

/// The first `width` characters of a printable text.
[[nodiscard]] std::string fitted(const std::string& text, std::size_t width);

}  // namespace nodmap::procman
