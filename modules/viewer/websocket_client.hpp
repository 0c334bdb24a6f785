// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "modules/viewer/heartbeat.hpp"
#include "modules/viewer/hub.hpp"

namespace nodmap::viewer {

/// The socket of a Session. Sends one frame at a time and queues none: the next frame is requested
/// from the session when the last one has been sent.
class WebSocketClient : public std::enable_shared_from_this<WebSocketClient> {
 public:
  using HttpRequest = boost::beast::http::request<boost::beast::http::empty_body>;

  WebSocketClient(boost::beast::tcp_stream stream, Hub& hub, std::unique_ptr<Ticket> ticket,
                  const Access& access);

  /// Answers the handshake and starts reading and sending.
  void start(const HttpRequest& request);

  /// Sends the news. To be called often.
  void poll();

  [[nodiscard]] Session& session() { return session_; }

 private:
  using ErrorCode = boost::beast::error_code;

  void yield_place();
  void set_options(const std::string& protocol);
  void on_accept(ErrorCode error);
  void read();
  void on_read(ErrorCode error);
  void write();
  void on_write(ErrorCode error);
  void ping();
  void count_refusals();

  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  Hub& hub_;
  std::unique_ptr<Ticket> ticket_;
  Session session_;
  boost::asio::steady_timer rest_;  // holds this object while it neither reads nor sends
  boost::beast::flat_buffer input_;
  std::optional<Frame> frame_;  // being sent
  Heartbeat heartbeat_;
  bool is_open_ = false;
  bool is_pinging_ = false;
  bool is_reading_ = false;
  int reads_left_ = 0;          // in this poll()
  std::size_t bytes_read_ = 0;  // more than the polls so far allow
  std::int64_t refusals_counted_ = 0;
};

}  // namespace nodmap::viewer
