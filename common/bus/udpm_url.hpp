// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace nodmap::bus {

/// The parts of a URL of LCM's multicast provider.
struct UdpmUrl {
  std::array<std::uint8_t, 4> group{239, 255, 76, 67};
  std::uint16_t port = 7667;
  int ttl = 0;  ///< 0: messages stay on this host
  /// Socket receive buffer to request from the kernel, bytes. Maps are sent in bursts of chunks of
  /// 60 kB, which every socket of the group must hold until its process runs again; three such
  /// chunks fill the kernel's default buffer.
  int receive_buffer_bytes = 4 << 20;

  [[nodiscard]] std::string group_text() const;
};

/// Parses udpm://GROUP:PORT?ttl=N&recv_buf_size=N. Missing parts get LCM's defaults, except for the
/// receive buffer. Returns nothing for another provider or an invalid URL.
[[nodiscard]] std::optional<UdpmUrl> parse_udpm_url(const std::string& url);

}  // namespace nodmap::bus
