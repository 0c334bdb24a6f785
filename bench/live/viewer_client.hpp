// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <boost/core/noncopyable.hpp>
#include <cstdint>
#include <memory>
#include <thread>

namespace nodmap::bench {

/// A client of nodmap-viewer (foxglove.websocket.v1) that subscribes to every topic and reads as
/// fast as the viewer sends, in its own thread. It counts messages and ignores their content.
class ViewerClient : private boost::noncopyable {
 public:
  /// Connects to this host, trying for ten seconds. Throws std::runtime_error if nothing answers.
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
