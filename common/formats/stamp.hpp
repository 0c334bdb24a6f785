// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

#include "common/geometry/time.hpp"

namespace nodmap::formats {

/// Parses "seconds.decimals" since the epoch, exact to the microsecond. (A double would be exact
/// only to 0.2 us today.) Digits beyond the sixth are cut off. Empty for anything else, including
/// scientific notation.
[[nodiscard]] std::optional<time::Timestamp> parse_stamp(std::string_view text);

}  // namespace nodmap::formats
