// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/attacker.hpp"

#include <arpa/inet.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

namespace nodmap::test {
namespace {

constexpr std::uint16_t kSourcePort = 40'000;

std::string big_endian(std::uint32_t value, int size) {
  std::string bytes;
  for (int i = size - 1; i >= 0; --i) {
    bytes += static_cast<char>(value >> (8 * i) & 0xFFU);
  }
  return bytes;
}

std::string fragment(std::uint32_t message_bytes, std::uint32_t offset, std::uint32_t number,
                     const std::string& payload) {
  return "LC03" + big_endian(0, 4) + big_endian(message_bytes, 4) + big_endian(offset, 4) +
         big_endian(number, 2) + big_endian(2, 2) + payload;
}

in_addr address_of(const char* host) {
  in_addr address{};
  if (::inet_pton(AF_INET, host, &address) != 1) {
    throw std::invalid_argument(std::string(host) + " is no IPv4 address");
  }
  return address;
}

}  // namespace

std::string datagram(const std::string& channel_and_data) {
  return "LC02" + big_endian(0, 4) + channel_and_data;
}

std::array<std::string, 2> two_fragments_that_wrap(const std::string& channel) {
  return {fragment(1000, 0, 0, channel + '\0'),
          fragment(1000, 0xFFFFFF00, 1, std::string(260, 'x'))};
}

Attacker::Attacker(std::uint16_t port)
    : group_{},
      udp_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)),
      raw_(::socket(AF_INET, SOCK_RAW | SOCK_CLOEXEC, IPPROTO_RAW)) {
  group_.sin_family = AF_INET;
  group_.sin_port = htons(port);
  group_.sin_addr = address_of("239.255.76.67");
}

Attacker::~Attacker() {
  ::close(udp_);
  ::close(raw_);
}

void Attacker::send(const std::string& datagram) const {
  send_on(udp_, datagram);
}

void Attacker::send_as(const char* source, const std::string& datagram) const {
  udphdr udp{};
  udp.source = htons(kSourcePort);
  udp.dest = group_.sin_port;
  udp.len = htons(static_cast<std::uint16_t>(sizeof(udp) + datagram.size()));
  iphdr ip{};  // the kernel sets length and checksum
  ip.version = 4;
  ip.ihl = 5;
  ip.ttl = 1;
  ip.protocol = IPPROTO_UDP;
  ip.saddr = address_of(source).s_addr;
  ip.daddr = group_.sin_addr.s_addr;
  std::string packet(sizeof(ip) + sizeof(udp), '\0');
  std::memcpy(packet.data(), &ip, sizeof(ip));
  std::memcpy(packet.data() + sizeof(ip), &udp, sizeof(udp));
  send_on(raw_, packet + datagram);
}

void Attacker::send_on(int socket, const std::string& bytes) const {
  if (::sendto(socket, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&group_),
               sizeof(group_)) != static_cast<ssize_t>(bytes.size())) {
    throw std::system_error(errno, std::system_category(), "cannot send a datagram");
  }
}

}  // namespace nodmap::test
