// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/websocket_client.hpp"

#include <algorithm>
#include <array>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <utility>

#include "common/geometry/clock.hpp"

namespace nodmap::viewer {
namespace {

namespace beast = boost::beast;
namespace websocket = beast::websocket;

// Far longer than subscriptions, parameters and goals.
constexpr std::size_t kMaxMessageBytes = 65536;
// What is read from one client in one poll(), so that a flood neither delays the others nor takes a
// processor from the robot: what exceeds it stays in the socket. A page sends some hundred bytes at
// a time.
constexpr int kReadsPerPoll = 50;
constexpr std::size_t kBytesPerPoll = 16384;
constexpr std::chrono::seconds kHandshakeTimeout = 5s;

}  // namespace

WebSocketClient::WebSocketClient(beast::tcp_stream stream, Hub& hub, std::unique_ptr<Ticket> ticket,
                                 const Access& access)
    : socket_(std::move(stream)),
      hub_(hub),
      ticket_(std::move(ticket)),
      session_(hub.store, hub.services, access.rights),
      rest_(socket_.get_executor(), boost::asio::steady_timer::time_point::max()),
      heartbeat_(time::steady_now()) {
  set_options(access.protocol);
  if (access.rights.may_control) {
    ticket_->on_yield(nullptr);
  } else {
    ticket_->on_yield([this] { yield_place(); });
  }
}

void WebSocketClient::yield_place() {
  hub_.refuse("replaced_reader");
  beast::get_lowest_layer(socket_).close();
}

void WebSocketClient::set_options(const std::string& protocol) {
  socket_.set_option(websocket::stream_base::timeout{
      kHandshakeTimeout, std::chrono::seconds(hub_.idle_timeout_s), true});
  socket_.set_option(
      websocket::stream_base::decorator([protocol](websocket::response_type& response) {
        response.set(beast::http::field::sec_websocket_protocol, protocol);
      }));
  socket_.read_message_max(kMaxMessageBytes);
  socket_.auto_fragment(false);
  socket_.control_callback([this](websocket::frame_type kind, beast::string_view payload) {
    if (kind == websocket::frame_type::pong) {
      heartbeat_.take_pong({payload.data(), payload.size()});
    }
  });
}

void WebSocketClient::start(const HttpRequest& request) {
  // From here on the WebSocket stream's own timeouts apply.
  beast::get_lowest_layer(socket_).expires_never();
  socket_.async_accept(request, [self = shared_from_this()](ErrorCode e) { self->on_accept(e); });
}

void WebSocketClient::on_accept(ErrorCode error) {
  if (error) {
    hub_.refuse("bad_handshake");
    return;
  }
  is_open_ = true;
  hub_.clients.push_back(weak_from_this());
  poll();
}

void WebSocketClient::poll() {
  reads_left_ = kReadsPerPoll;
  bytes_read_ -= std::min(bytes_read_, kBytesPerPoll);
  rest_.cancel();
  read();
  write();
  ping();
}

void WebSocketClient::read() {
  if (!is_open_ || is_reading_) {
    return;
  }
  if (reads_left_ <= 0 || bytes_read_ >= kBytesPerPoll) {
    rest_.async_wait([self = shared_from_this()](ErrorCode) {});  // until the next poll()
    return;
  }
  is_reading_ = true;
  --reads_left_;
  socket_.async_read(input_,
                     [self = shared_from_this()](ErrorCode e, std::size_t) { self->on_read(e); });
}

void WebSocketClient::on_read(ErrorCode error) {
  is_reading_ = false;
  if (error) {
    is_open_ = false;
    if (error == websocket::error::message_too_big) {
      hub_.refuse("message_too_big");
    } else if (error.category() == beast::error_code(websocket::error::bad_opcode).category() &&
               error != websocket::error::closed) {
      hub_.refuse("malformed_frame");
    }
    return;
  }
  const auto data = input_.data();
  bytes_read_ += data.size();
  if (socket_.got_text()) {
    session_.receive_text({static_cast<const char*>(data.data()), data.size()});
  } else {
    session_.receive_binary({static_cast<const std::byte*>(data.data()), data.size()},
                            heartbeat_.max_age(time::steady_now()));
  }
  input_.consume(input_.size());
  count_refusals();
  write();
  read();
}

void WebSocketClient::count_refusals() {
  for (; refusals_counted_ < session_.refused(); ++refusals_counted_) {
    hub_.refuse("request_not_allowed");
  }
}

void WebSocketClient::ping() {
  if (!is_open_ || is_pinging_) {
    return;
  }
  if (const auto payload = heartbeat_.next_ping(time::steady_now())) {
    is_pinging_ = true;
    socket_.async_ping({payload->data(), payload->size()},
                       [self = shared_from_this()](ErrorCode) { self->is_pinging_ = false; });
  }
}

void WebSocketClient::write() {
  if (!is_open_ || frame_) {
    return;
  }
  frame_ = session_.next(hub_.sends_news);
  if (!frame_) {
    return;
  }
  using boost::asio::buffer;
  const std::array<boost::asio::const_buffer, 2> parts{
      buffer(frame_->head),
      frame_->post ? buffer(frame_->post->text()) : boost::asio::const_buffer()};
  socket_.binary(frame_->is_binary);
  socket_.async_write(parts,
                      [self = shared_from_this()](ErrorCode e, std::size_t) { self->on_write(e); });
}

void WebSocketClient::on_write(ErrorCode error) {
  frame_.reset();
  if (error) {
    is_open_ = false;
    return;
  }
  write();
}

}  // namespace nodmap::viewer
