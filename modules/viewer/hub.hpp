// SPDX-License-Identifier: BSD-3-Clause
// The data shared by all connections of a server.
#pragma once

#include <boost/core/noncopyable.hpp>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "common/node/log.hpp"
#include "common/node/message_counts.hpp"
#include "modules/viewer/access.hpp"
#include "modules/viewer/foxglove/topic_store.hpp"
#include "modules/viewer/session.hpp"
#include "modules/viewer/site.hpp"

namespace nodmap::viewer {

class HttpConnection;
class WebSocketClient;

struct Hub {
  const Site& site;
  const foxglove::TopicStore& store;
  const Services& services;
  AccessPolicy policy;
  int max_connections = 0;
  int idle_timeout_s = 0;
  bool sends_news = true;  ///< whether news is sent now; see Session::next()
  node::MessageCounts counts{};
  log::Throttle throttle{};
  int connections = 0;
  std::vector<std::weak_ptr<WebSocketClient>> clients{};
  std::deque<std::weak_ptr<HttpConnection>>
      requests{};  ///< connections in their HTTP phase, the oldest first

  /// Counts a refusal, and logs it at most once in five seconds. `cause` is a snake_case word.
  void refuse(const std::string& cause) {
    counts.reject(cause);
    if (throttle.ready()) {
      log::get().warn("refused a client: {} ({} refusals so far)", cause, counts.total_rejected());
    }
  }
};

/// Counts a connection during its lifetime.
class Ticket : boost::noncopyable {
 public:
  explicit Ticket(Hub& hub) : hub_(hub) { ++hub_.connections; }
  ~Ticket() { --hub_.connections; }

 private:
  Hub& hub_;
};

}  // namespace nodmap::viewer
