// SPDX-License-Identifier: BSD-3-Clause
// What somebody on the network can send to LCM, right or wrong.
#pragma once

#include <netinet/in.h>

#include <array>
#include <boost/core/noncopyable.hpp>
#include <cstdint>
#include <string>

namespace nodmap::test {

/// A message in one LCM datagram; `channel_and_data` is the channel, a NUL and the encoded message.
[[nodiscard]] std::string datagram(const std::string& channel_and_data);

/// Two fragments of one message, of which the second one's offset and size wrap at 2^32: liblcm
/// 1.3.1 and 1.5.2 write 260 bytes in front of the message's memory.
[[nodiscard]] std::array<std::string, 2> two_fragments_that_wrap(const std::string& channel);

/// Sends bytes to LCM's multicast group (239.255.76.67) as they are. Throws std::system_error. To
/// forge a source takes the rights of root, which a private network gives.
class Attacker : private boost::noncopyable {
 public:
  explicit Attacker(std::uint16_t port);
  ~Attacker();

  /// As this host does.
  void send(const std::string& datagram) const;
  /// In an IP packet whose source (dotted) says that it comes from another host.
  void send_as(const char* source, const std::string& datagram) const;

 private:
  void send_on(int socket, const std::string& bytes) const;

  sockaddr_in group_;
  int udp_;
  int raw_;
};

}  // namespace nodmap::test
