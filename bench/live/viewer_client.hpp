// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <boost/core/noncopyable.hpp>
#include <cstdint>
#include <memory>
#include <thread>

namespace nodmap::bench {

/// One client of nodmap-viewer that wants every topic and reads as fast as it is sent
/// (foxglove.websocket.v1), in a thread of its own. What it reads is counted, not looked at.
class ViewerClient : private boost::noncopyable {
 public:
  /// Connects to this host, trying for ten seconds. Throws std::runtime_error when nobody answers.
  explicit ViewerClient(std::uint16_t port);
  ~ViewerClient();

  [[nodiscard]] std::int64_t messages() const { return messages_; }
  [[nodiscard]] std::int64_t bytes() const { return bytes_; }

 private:
  struct Connection;

  void subscribe_to_all();
  void read_until_closed();

  std::atomic<std::int64_t> messages_ = 0;
  std::atomic<std::int64_t> bytes_ = 0;
  std::unique_ptr<Connection> connection_;
  std::thread reader_;
};

}  // namespace nodmap::bench
