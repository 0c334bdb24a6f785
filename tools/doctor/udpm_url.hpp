// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace nodmap::doctor {

/// Where LCM's multicast provider sends to.
struct UdpmUrl {
  std::array<std::uint8_t, 4> group{239, 255, 76, 67};
  std::uint16_t port = 7667;
  int ttl = 0;  ///< 0: messages stay on this host

  [[nodiscard]] std::string group_text() const;
};

/// Reads udpm://GROUP:PORT?ttl=N, with LCM's defaults for what is left out. Nothing for another
/// provider or a URL that cannot be read.
[[nodiscard]] std::optional<UdpmUrl> parse_udpm_url(const std::string& url);

}  // namespace nodmap::doctor
