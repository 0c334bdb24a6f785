// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/http_connection.hpp"

#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <utility>

#include "modules/viewer/websocket_client.hpp"

namespace nodmap::viewer {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;

constexpr std::uint32_t kMaxHeadBytes = 8192;
// Timeout for receiving a request.
constexpr std::chrono::seconds kReadTimeout = 10s;
// Timeout for sending an answer: a megabyte of three.js over a slow radio link.
constexpr std::chrono::seconds kWriteTimeout = 60s;
constexpr const char* kText = "text/plain; charset=utf-8";

// The page loads nothing from other servers, and must not be embedded in another page.
constexpr const char* kContentSecurityPolicy =
    "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

std::string to_string(beast::string_view text) {
  return {text.data(), text.size()};
}

const char* cause_of(Refusal refusal) {
  switch (refusal) {
    case Refusal::kHost:
      return "foreign_host";
    case Refusal::kProtocol:
      return "unknown_subprotocol";
    case Refusal::kToken:
      return "wrong_token";
    case Refusal::kNone:
      break;
  }
  return "none";
}

}  // namespace

HttpConnection::HttpConnection(beast::tcp_stream stream, Hub& hub)
    : stream_(std::move(stream)),
      hub_(hub),
      ticket_(std::make_unique<Ticket>(hub, [this] { yield_place(); })),
      input_(std::size_t{2} * kMaxHeadBytes) {}

void HttpConnection::yield_place() {
  hub_.refuse("slow_request");
  stream_.close();
}

void HttpConnection::read() {
  parser_.emplace();
  parser_->header_limit(kMaxHeadBytes);
  parser_->body_limit(0);
  stream_.expires_after(kReadTimeout);
  http::async_read(stream_, input_, *parser_,
                   [self = shared_from_this()](ErrorCode e, std::size_t) { self->on_read(e); });
}

void HttpConnection::on_read(ErrorCode error) {
  if (error == http::error::end_of_stream || error == beast::error::timeout ||
      error == boost::asio::error::connection_reset ||
      error == boost::asio::error::operation_aborted) {
    return;
  }
  if (error) {
    hub_.refuse("bad_request");
    answer(http::status::bad_request, kText, "malformed request\n");
    return;
  }
  if (beast::websocket::is_upgrade(parser_->get())) {
    upgrade();
  } else {
    serve();
  }
}

void HttpConnection::upgrade() {
  const auto& head = parser_->get();
  const Access access =
      decide_access({.target = to_string(head.target()),
                     .host = to_string(head[http::field::host]),
                     .origin = to_string(head[http::field::origin]),
                     .protocols = to_string(head[http::field::sec_websocket_protocol])},
                    hub_.policy);
  if (access.refusal != Refusal::kNone) {
    hub_.refuse(cause_of(access.refusal));
    answer(
        access.refusal == Refusal::kProtocol ? http::status::bad_request : http::status::forbidden,
        kText, std::string_view(cause_of(access.refusal)));
    return;
  }
  std::make_shared<WebSocketClient>(std::move(stream_), hub_, std::move(ticket_), access)
      ->start(head);
}

void HttpConnection::serve() {
  const auto& head = parser_->get();
  if (hub_.policy.loopback_only && !is_this_host(to_string(head[http::field::host]))) {
    hub_.refuse("foreign_host");
    answer(http::status::forbidden, kText, "this server accepts requests for this host only\n");
    return;
  }
  if (head.method() != http::verb::get && head.method() != http::verb::head) {
    hub_.refuse("method_not_allowed");
    answer(http::status::method_not_allowed, kText, "GET and HEAD only\n");
    return;
  }
  const SiteFile* file = hub_.site.find(to_string(head.target()));
  if (file == nullptr) {
    hub_.refuse("no_such_file");
    answer(http::status::not_found, kText, "no such file\n");
    return;
  }
  answer(http::status::ok, file->content_type, file->content);
}

void HttpConnection::answer(http::status status, std::string_view content_type,
                            std::string_view content) {
  response_ = {};
  response_.result(status);
  response_.version(11);
  response_.set(http::field::content_type,
                beast::string_view(content_type.data(), content_type.size()));
  response_.set(http::field::cache_control, "no-cache");
  response_.set("X-Content-Type-Options", "nosniff");
  response_.set("Referrer-Policy", "no-referrer");
  response_.set("Content-Security-Policy", kContentSecurityPolicy);
  response_.keep_alive(status == http::status::ok && parser_->get().keep_alive());
  response_.content_length(content.size());
  if (parser_->get().method() != http::verb::head) {
    // The site and the texts exist until the program ends.
    response_.body() = {content.data(), content.size()};
  }
  stream_.expires_after(kWriteTimeout);
  http::async_write(stream_, response_,
                    [self = shared_from_this()](ErrorCode e, std::size_t) { self->on_write(e); });
}

void HttpConnection::on_write(ErrorCode error) {
  if (error || !response_.keep_alive()) {
    ErrorCode ignored;
    stream_.socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
    return;
  }
  read();
}

}  // namespace nodmap::viewer
