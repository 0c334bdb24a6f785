// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/server.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <utility>

#include "common/node/program.hpp"
#include "modules/viewer/http_connection.hpp"
#include "modules/viewer/websocket_client.hpp"

namespace nodmap::viewer {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using ErrorCode = boost::system::error_code;

// Small, so that a slow client does not receive old data.
constexpr int kSendBufferBytes = 1 << 17;
// Pause when there are no file descriptors left, until other connections close.
constexpr std::chrono::milliseconds kPause = 100ms;

asio::ip::address parse_address(const std::string& text) {
  ErrorCode error;
  asio::ip::address address =
      asio::ip::make_address(text == "localhost" ? "127.0.0.1" : text, error);
  if (error) {
    throw node::UsageError("--bind '" + text + "' is not an address");
  }
  return address;
}

}  // namespace

bool is_loopback(const std::string& address) {
  return parse_address(address).is_loopback();
}

struct Server::Impl {
  Impl(Hub& the_hub, const tcp::endpoint& endpoint)
      : hub(the_hub), acceptor(context), pause(context) {
    acceptor.open(endpoint.protocol());
    acceptor.set_option(asio::socket_base::reuse_address(true));
    acceptor.bind(endpoint);
    acceptor.listen();
    accept();
  }

  void accept() {
    acceptor.async_accept(
        [this](ErrorCode error, tcp::socket socket) { on_accept(error, std::move(socket)); });
  }

  void on_accept(ErrorCode error, tcp::socket socket) {
    if (error) {
      pause.expires_after(kPause);
      pause.async_wait([this](ErrorCode) { accept(); });
      return;
    }
    if (is_full() && !make_room()) {
      hub.refuse("too_many_connections");
    } else {
      ErrorCode ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      socket.set_option(asio::socket_base::send_buffer_size(kSendBufferBytes), ignored);
      std::make_shared<HttpConnection>(boost::beast::tcp_stream(std::move(socket)), hub)->start();
    }
    accept();
  }

  [[nodiscard]] bool is_full() const {
    return hub.tickets.size() >= static_cast<std::size_t>(hub.max_connections);
  }

  // Ends the oldest connection that does not control the robot. Whoever wants to control it sends
  // the token within milliseconds, before as many others have come. So however many only read, and
  // however many say nothing, they keep nobody with the token out. Returns whether there was one.
  bool make_room() {
    const auto oldest = std::ranges::find_if(hub.tickets, &Ticket::may_yield);
    if (oldest == hub.tickets.end()) {
      return false;
    }
    (*oldest)->yield();
    return true;
  }

  template <class Do>
  void for_each_client(Do act) {
    std::erase_if(hub.clients, [](const auto& client) { return client.expired(); });
    for (const auto& weak : hub.clients) {
      if (const auto client = weak.lock()) {
        act(*client);
      }
    }
  }

  Hub& hub;
  asio::io_context context{1};
  tcp::acceptor acceptor;
  asio::steady_timer pause;
};

Server::Server(Hub& hub, const std::string& address, std::uint16_t port) {
  try {
    impl_ = std::make_unique<Impl>(hub, tcp::endpoint(parse_address(address), port));
  } catch (const boost::system::system_error& error) {
    throw std::runtime_error("cannot listen on " + address + ":" + std::to_string(port) + ": " +
                             error.code().message());
  }
}

Server::~Server() = default;

void Server::run_for(std::chrono::milliseconds duration) {
  impl_->context.run_for(duration);
}

void Server::poll() {
  impl_->for_each_client([](WebSocketClient& client) { client.poll(); });
}

void Server::send_time(time::Timestamp stamp) {
  impl_->for_each_client([stamp](WebSocketClient& client) { client.session().send_time(stamp); });
}

void Server::send_changed_parameters() {
  impl_->for_each_client(
      [](WebSocketClient& client) { client.session().send_changed_parameters(); });
}

std::uint16_t Server::port() const {
  return impl_->acceptor.local_endpoint().port();
}

}  // namespace nodmap::viewer
