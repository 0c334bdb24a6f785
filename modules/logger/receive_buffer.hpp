// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace nodmap::logger {

/// Adds a request for a socket buffer of `size_bytes` to the URL. Returns the URL unchanged if the
/// size is 0, if it already names a buffer size, or if it is not a udpm URL (other providers have
/// no such buffer).
[[nodiscard]] std::string with_receive_buffer(const std::string& url, std::int64_t size_bytes);

}  // namespace nodmap::logger
