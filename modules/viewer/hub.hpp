// SPDX-License-Identifier: BSD-3-Clause
// The data shared by all connections of a server.
#pragma once

#include <boost/core/noncopyable.hpp>
#include <functional>
#include <list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/node/log.hpp"
#include "common/node/message_counts.hpp"
#include "modules/viewer/access.hpp"
#include "modules/viewer/foxglove/topic_store.hpp"
#include "modules/viewer/session.hpp"
#include "modules/viewer/site.hpp"

namespace nodmap::viewer {

class Ticket;
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
  std::list<Ticket*> tickets{};  ///< one for each connection, the oldest first
  std::vector<std::weak_ptr<WebSocketClient>> clients{};

  /// Counts a refusal, and logs it at most once in five seconds. `cause` is a snake_case word.
  void refuse(const std::string& cause) {
    counts.reject(cause);
    if (throttle.ready()) {
      log::get().warn("refused a client: {} ({} refusals so far)", cause, counts.total_rejected());
    }
  }
};

/// The place of a connection among all others, during its lifetime.
class Ticket : boost::noncopyable {
 public:
  /// `yield` ends the connection, to give its place to a newer one.
  Ticket(Hub& hub, std::function<void()> yield)
      : hub_(hub), place_(hub.tickets.insert(hub.tickets.end(), this)), yield_(std::move(yield)) {}
  ~Ticket() { hub_.tickets.erase(place_); }

  /// Replaces what ends the connection; null: it keeps its place.
  void on_yield(std::function<void()> yield) { yield_ = std::move(yield); }
  [[nodiscard]] bool may_yield() const { return yield_ != nullptr; }
  /// Ends the connection. Its ticket may exist for some time afterwards, but does not yield again.
  void yield() { std::exchange(yield_, nullptr)(); }

 private:
  Hub& hub_;
  std::list<Ticket*>::iterator place_;
  std::function<void()> yield_;
};

}  // namespace nodmap::viewer
