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

/// Serves HTTP and WebSocket on one port, in the thread of its caller.
class Server : boost::noncopyable {
 public:
  /// Port 0 selects a free one. Throws std::runtime_error with address and port if it cannot listen
  /// there. The hub must outlive this object.
  Server(Hub& hub, const std::string& address, std::uint16_t port);
  ~Server();

  /// Serves for this long.
  void run_for(std::chrono::milliseconds duration);

  /// Sends every client the news in the topic store.
  void poll();
  void send_time(time::Timestamp stamp);
  void send_changed_parameters();

  [[nodiscard]] std::uint16_t port() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether an address is a loopback address. Throws node::UsageError for an invalid address.
[[nodiscard]] bool is_loopback(const std::string& address);

}  // namespace nodmap::viewer
