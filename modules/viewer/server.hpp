// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "common/geometry/time.hpp"
#include "modules/viewer/hub.hpp"

namespace nodmap::viewer {

/// HTTP and WebSocket on one port, in the thread of its caller.
class Server : boost::noncopyable {
 public:
  /// Port 0 takes a free one. Throws std::runtime_error naming address and port when it cannot
  /// listen there. The hub must outlive this object.
  Server(Hub& hub, const std::string& address, std::uint16_t port);
  ~Server();

  /// Serves for so long.
  void run_for(std::chrono::milliseconds duration);

  /// Sends every client what is new in the topic store.
  void turn();
  void send_time(time::Timestamp stamp);
  void send_changed_parameters();

  [[nodiscard]] std::uint16_t port() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether an address is that of this host alone. Throws node::UsageError for what is no
/// address.
[[nodiscard]] bool is_loopback(const std::string& address);

}  // namespace nodmap::viewer
