// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/span_body.hpp>
#include <memory>
#include <optional>
#include <string_view>

#include "modules/viewer/hub.hpp"

namespace nodmap::viewer {

/// A connection in its HTTP phase: serves files of the site, or becomes a WebSocketClient.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(boost::beast::tcp_stream stream, Hub& hub);

  void start() { read(); }

 private:
  using ErrorCode = boost::beast::error_code;
  using Parser = boost::beast::http::request_parser<boost::beast::http::empty_body>;
  using Response = boost::beast::http::response<boost::beast::http::span_body<const char>>;

  void yield_place();
  void read();
  void on_read(ErrorCode error);
  void upgrade();
  void serve();
  void answer(boost::beast::http::status status, std::string_view content_type,
              std::string_view content);
  void on_write(ErrorCode error);

  boost::beast::tcp_stream stream_;
  Hub& hub_;
  std::unique_ptr<Ticket> ticket_;
  boost::beast::flat_buffer input_;
  std::optional<Parser> parser_;  // one for each request
  Response response_;
};

}  // namespace nodmap::viewer
