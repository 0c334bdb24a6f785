// SPDX-License-Identifier: BSD-3-Clause
// Sends valid and malformed LCM datagrams, as anybody on the network could.
#pragma once

#include <netinet/in.h>

#include <array>
#include <boost/core/noncopyable.hpp>
#include <cstdint>
#include <string>

namespace nodmap::test {

/// One LCM datagram with a whole message; `channel_and_data`: channel, NUL, encoded message.
[[nodiscard]] std::string datagram(const std::string& channel_and_data);

/// Two fragments of one message; offset plus size of the second wraps at 2^32. liblcm 1.3.1 and
/// 1.5.2 write 260 bytes in front of the message's memory.
[[nodiscard]] std::array<std::string, 2> two_fragments_that_wrap(const std::string& channel);

/// Sends raw bytes to LCM's multicast group (239.255.76.67). Throws std::system_error. Forging a
/// source address needs root rights, which a private network gives.
class Attacker : private boost::noncopyable {
 public:
  explicit Attacker(std::uint16_t port);
  ~Attacker();

  /// From this host's address.
  void send(const std::string& datagram) const;
  /// In an IP packet with a forged source address (dotted).
  void send_as(const char* source, const std::string& datagram) const;

 private:
  void send_on(int socket, const std::string& bytes) const;

  sockaddr_in group_;
  int udp_;
  int raw_;
};

}  // namespace nodmap::test
