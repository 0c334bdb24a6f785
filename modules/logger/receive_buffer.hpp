// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace nodmap::logger {

/// The URL asking for a socket buffer of this size; as it is when it names one already, when it is
/// no udpm URL (no other provider has such a buffer), or for 0.
[[nodiscard]] std::string with_receive_buffer(const std::string& url, std::int64_t size_bytes);

}  // namespace nodmap::logger
