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
  int ttl = 0;  ///< 0: messages stay on this host
  /// Asked of the kernel for the socket. Maps go out as bursts of parts of 60 kB, which every
  /// socket of the group holds until its process runs again: three of them fill the kernel's
  /// default.
  int receive_buffer_bytes = 4 << 20;

  [[nodiscard]] std::string group_text() const;
};

/// Reads udpm://GROUP:PORT?ttl=N&recv_buf_size=N, with LCM's defaults for what is left out, but for
/// the receive buffer. Nothing for another provider or a URL that cannot be read.
[[nodiscard]] std::optional<UdpmUrl> parse_udpm_url(const std::string& url);

}  // namespace nodmap::bus
