// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

#include "common/geometry/time.hpp"

namespace nodmap::formats {

/// Reads "seconds.decimals" since the epoch, exactly to the microsecond: a double holds today's
/// epoch only to 0.2 us. Digits beyond the sixth are cut off. Empty for anything else, scientific
/// notation included.
[[nodiscard]] std::optional<time::Timestamp> parse_stamp(std::string_view text);

}  // namespace nodmap::formats
