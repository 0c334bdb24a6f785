// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/bus/sender.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::bus {

/// Buffers for several datagrams of a socket of open_multicast_socket(), filled by one system call.
class DatagramBatch {
 public:
  /// The most that one call receives. Fewer: none waits any more.
  static constexpr std::size_t kBatch = 16;

  /// Receives the datagrams that wait in the socket, without blocking. Returns their number; -1 if
  /// there are none.
  int receive(int socket);

  [[nodiscard]] std::span<const std::byte> datagram(std::size_t i) const {
    return std::span(bytes_).subspan(i * kMaxDatagramBytes, headers_.at(i).msg_len);
  }
  [[nodiscard]] Sender sender(std::size_t i) const {
    return {ntohl(from_.at(i).sin_addr.s_addr), ntohs(from_.at(i).sin_port)};
  }
  /// The kernel's time of arrival; the present time if the kernel gave none.
  [[nodiscard]] time::Timestamp received(std::size_t i);
  /// Number of datagrams dropped because the socket's buffer was full, since it was opened; wraps
  /// at 2^32.
  [[nodiscard]] std::uint32_t num_dropped(std::size_t i);

 private:
  static constexpr std::size_t kMaxDatagramBytes = 65'536;  // UDP's largest is shorter
  struct alignas(cmsghdr) Control : std::array<char, 64> {};

  std::vector<std::byte> bytes_ = std::vector<std::byte>(kBatch * kMaxDatagramBytes);
  std::array<sockaddr_in, kBatch> from_{};
  std::array<iovec, kBatch> parts_{};
  std::array<Control, kBatch> control_{};
  std::array<mmsghdr, kBatch> headers_{};
};

}  // namespace nodmap::bus
