// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/geometry/time.hpp"

namespace nodmap::viewer {

/// Bounds the age of a client's messages by pings, which every client answers by itself. A
/// connection keeps the order: what arrives after the answer to a ping was sent after that ping.
/// While the link is down, messages wait in the client's host and no ping is answered. The times
/// are steady, so that setting the clock does not make a message younger.
class Heartbeat {
 public:
  static constexpr time::Duration kPeriod = 500ms;

  /// `opened`: before the handshake was answered; a client cannot send messages earlier.
  explicit Heartbeat(time::SteadyTime opened) : sent_(opened), answered_(opened) {}

  /// The payload of the ping to be sent now; empty if none is due or one is not yet answered.
  [[nodiscard]] std::optional<std::string> next_ping(time::SteadyTime now);

  /// Takes the payload of a pong. Pongs that do not answer the newest ping are ignored.
  void take_pong(std::string_view payload);

  /// The greatest age of a message that arrives now.
  [[nodiscard]] time::Duration max_age(time::SteadyTime now) const { return now - answered_; }

 private:
  time::SteadyTime sent_;      // newest ping
  time::SteadyTime answered_;  // when the newest ping that has been answered was sent
  std::int64_t number_ = 0;    // of the newest ping
  bool is_waiting_ = false;
};

}  // namespace nodmap::viewer
