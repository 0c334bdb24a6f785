// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

#include "common/geometry/time.hpp"

namespace nodmap::formats {

/// Parses seconds since the epoch, "123.5" or, as numpy writes it, "1.235e+02", exact to the
/// microsecond. (A double would be exact only to 0.2 us today.) Rounded to microseconds, because
/// with all its digits a double is a little more or less than what it was read from. Empty for
/// anything else.
[[nodiscard]] std::optional<time::Timestamp> parse_stamp(std::string_view text);

}  // namespace nodmap::formats
