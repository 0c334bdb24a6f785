// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace nodmap::formats {

/// Microseconds from "seconds.decimals", exactly: a double holds today's epoch only to 0.2 us.
/// Digits beyond the sixth are cut off. Empty for anything else, scientific notation included.
[[nodiscard]] std::optional<std::int64_t> parse_stamp_us(std::string_view text);

}  // namespace nodmap::formats
