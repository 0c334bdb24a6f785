// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as what a browser sends to the viewer's port: as they are, or, if the first byte is
// odd, as frames after a valid handshake. The server stays usable.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "modules/viewer/server.hpp"

namespace {

using namespace nodmap::viewer;  // NOLINT(google-build-using-namespace): a program of one page
using std::chrono::milliseconds;

constexpr const char* kHandshake =
    "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
    "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n\r\n";

struct Viewer {
  Site site;
  nodmap::foxglove::TopicStore store;
  Services services;
  Hub hub{.site = site,
          .store = store,
          .services = services,
          .policy = {},
          .max_connections = 10,
          .idle_timeout_s = 10};
  Server server{hub, "127.0.0.1", 0};
};

void send(int socket, const std::string& bytes) {
  static_cast<void>(::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Viewer viewer;
  spdlog::set_level(spdlog::level::off);
  if (size == 0) {
    return 0;
  }
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(viewer.server.port());
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    std::abort();
  }
  if (data[0] % 2 == 1) {
    send(socket, kHandshake);
    viewer.server.run_for(milliseconds(1));
  }
  send(socket, std::string(reinterpret_cast<const char*>(data + 1), size - 1));
  viewer.server.run_for(milliseconds(1));
  viewer.server.poll();
  ::close(socket);
  viewer.server.run_for(milliseconds(1));
  if (viewer.hub.tickets.size() > static_cast<std::size_t>(viewer.hub.max_connections + 1)) {
    std::abort();
  }
  return 0;
}
