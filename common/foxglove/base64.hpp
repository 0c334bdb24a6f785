// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace nodmap::foxglove {

/// RFC 4648, with padding: how bytes travel in JSON.
[[nodiscard]] std::string base64(std::span<const std::byte> bytes);

}  // namespace nodmap::foxglove
