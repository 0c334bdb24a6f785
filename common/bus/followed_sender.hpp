// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/bus/sender.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::bus {

/// Follows one sender until it has been silent for a given time; then the next one to send.
class FollowedSender {
 public:
  explicit FollowedSender(time::Duration silence) : silence_(silence) {}

  /// Adds a message; returns whether it is from the sender that is followed. All times must be of
  /// one clock; if it steps back, the sender of this message is followed.
  [[nodiscard]] bool follow(const Sender& sender, time::SteadyTime now) {
    if (is_alive(now) && sender != sender_) {
      return false;
    }
    sender_ = sender;
    last_ = now;
    return true;
  }

  /// Whether a sender is followed and has been heard recently.
  [[nodiscard]] bool is_alive(time::SteadyTime now) const {
    return last_ && now >= *last_ && now - *last_ < silence_;
  }

  /// The sender that is followed, or was before it was silent.
  [[nodiscard]] const Sender& sender() const { return sender_; }

  /// Adds that a sender has ended; returns whether it was followed. The next one to send then takes
  /// its place.
  bool end(const Sender& sender) {
    const bool was_followed = last_ && sender == sender_;
    if (was_followed) {
      last_.reset();
    }
    return was_followed;
  }

 private:
  time::Duration silence_;
  Sender sender_;
  std::optional<time::SteadyTime> last_;  // its last message
};

}  // namespace nodmap::bus
