// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/multicast_socket.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <bit>
#include <cerrno>
#include <cstdint>
#include <system_error>

namespace nodmap::bus {
namespace {

template <class Value>
void set_option(int socket, int level, int name, const Value& value, const char* what) {
  if (::setsockopt(socket, level, name, &value, sizeof(value)) != 0) {
    throw std::system_error(errno, std::system_category(), what);
  }
}

}  // namespace

formats::FileDescriptor open_multicast_socket(const UdpmUrl& url) {
  formats::FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0), "socket");
  set_option(socket.get(), SOL_SOCKET, SO_REUSEADDR, 1, "SO_REUSEADDR");
  set_option(socket.get(), SOL_SOCKET, SO_TIMESTAMP, 1, "SO_TIMESTAMP");
  set_option(socket.get(), SOL_SOCKET, SO_RXQ_OVFL, 1, "SO_RXQ_OVFL");
  // A buffer larger than net.core.rmem_max needs a privilege (CAP_NET_ADMIN). Without it the kernel
  // limits the size; nodmap-doctor reports that.
  const int wanted = url.receive_buffer_bytes;
  if (::setsockopt(socket.get(), SOL_SOCKET, SO_RCVBUFFORCE, &wanted, sizeof(wanted)) != 0) {
    set_option(socket.get(), SOL_SOCKET, SO_RCVBUF, wanted, "SO_RCVBUF");
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(url.port);
  address.sin_addr.s_addr = std::bit_cast<std::uint32_t>(url.group);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the C interface wants it
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    throw std::system_error(errno, std::system_category(), "bind to " + url.group_text());
  }
  const ip_mreq membership{.imr_multiaddr = address.sin_addr, .imr_interface = {INADDR_ANY}};
  set_option(socket.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, membership, "IP_ADD_MEMBERSHIP");
  return socket;
}

}  // namespace nodmap::bus
