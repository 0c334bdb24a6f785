// SPDX-License-Identifier: BSD-3-Clause
#include "bench/live/viewer_client.hpp"

#include <sys/socket.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

namespace nodmap::bench {
namespace {

namespace beast = boost::beast;
using boost::asio::ip::tcp;

constexpr std::chrono::milliseconds kPause(100);
constexpr int kTries = 100;  // 10 s in total

}  // namespace

struct ViewerClient::Connection {
  boost::asio::io_context context;
  beast::websocket::stream<tcp::socket> socket{context};
  beast::flat_buffer buffer;

  void connect(std::uint16_t port) {
    const tcp::endpoint endpoint(boost::asio::ip::address_v4::loopback(), port);
    boost::system::error_code error;
    for (int i = 0; i < kTries; ++i) {
      socket.next_layer().connect(endpoint, error);
      if (!error) {
        break;
      }
      socket.next_layer().close();
      std::this_thread::sleep_for(kPause);
    }
    if (error) {
      throw std::runtime_error("nodmap-viewer does not answer: " + error.message());
    }
    socket.set_option(
        beast::websocket::stream_base::decorator([](beast::websocket::request_type& request) {
          request.set(beast::http::field::sec_websocket_protocol, "foxglove.websocket.v1");
        }));
    socket.handshake("127.0.0.1:" + std::to_string(port), "/");
  }

  nlohmann::json read_text() {
    buffer.clear();
    socket.read(buffer);
    return nlohmann::json::parse(beast::buffers_to_string(buffer.data()));
  }
};

ViewerClient::ViewerClient(std::uint16_t port) : connection_(std::make_unique<Connection>()) {
  connection_->connect(port);
  subscribe_to_all();
  reader_ = std::thread([this] { read_until_closed(); });
}

ViewerClient::~ViewerClient() {
  // Wakes the reading thread; the viewer sees a client that disconnected without a close frame.
  ::shutdown(connection_->socket.next_layer().native_handle(), SHUT_RDWR);
  reader_.join();
}

void ViewerClient::subscribe_to_all() {
  (void)connection_->read_text();  // serverInfo
  const nlohmann::json offered = connection_->read_text();
  nlohmann::json wishes = nlohmann::json::array();
  for (const auto& channel : offered.at("channels")) {
    wishes.push_back({{"id", wishes.size()}, {"channelId", channel.at("id")}});
  }
  const std::string request = nlohmann::json{{"op", "subscribe"}, {"subscriptions", wishes}}.dump();
  connection_->socket.text(true);
  connection_->socket.write(boost::asio::buffer(request));
}

void ViewerClient::read_until_closed() {
  boost::system::error_code error;
  while (true) {
    connection_->buffer.clear();
    const std::size_t size = connection_->socket.read(connection_->buffer, error);
    if (error) {
      return;
    }
    ++messages_;
    bytes_ += static_cast<std::int64_t>(size);
  }
}

}  // namespace nodmap::bench
