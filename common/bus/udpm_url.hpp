// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace nodmap::bus {

/// Where LCM's multicast provider sends to.
struct UdpmUrl {
  std::array<std::uint8_t, 4> group{239, 255, 76, 67};
  std::uint16_t port = 7667;
  int ttl = 0;                   ///< 0: messages stay on this host
  int receive_buffer_bytes = 0;  ///< asked of the kernel for the socket; 0: its default

  [[nodiscard]] std::string group_text() const;
};

/// Reads udpm://GROUP:PORT?ttl=N&recv_buf_size=N, with LCM's defaults for what is left out. Nothing
/// for another provider or a URL that cannot be read.
[[nodiscard]] std::optional<UdpmUrl> parse_udpm_url(const std::string& url);

}  // namespace nodmap::bus
