// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <boost/circular_buffer.hpp>
#include <optional>

#include "common/bus/followed_sender.hpp"
#include "common/bus/sender.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::bus {

/// Accepts the messages of one sender, and detects a second sender.
///
/// While the accepted sender is alive, a message from another socket is from a stranger, whatever
/// it contains. Several of them mean that there are two senders; which one is legitimate is not
/// known. Two are assumed only once the accepted one sends again, because a process that has
/// restarted has a new socket, too. A new or restarted sender is accepted once the old one has been
/// silent.
///
/// All times must be of one clock; if it steps back, the watch starts again. It does not protect
/// against a sender that is alone or that stops the legitimate sender first.
class SenderWatch {
 public:
  /// After this much silence the accepted sender is considered gone, and another may be accepted.
  static constexpr time::Duration kSilence = 200ms;
  /// This many strangers in a second are worth stopping for. Fewer have no effect.
  static constexpr int kStrangersOfASecondSender = 3;
  /// Strangers are counted over this time, and for this long after the last one two senders are
  /// still assumed.
  static constexpr time::Duration kContested = 1s;

  SenderWatch() = default;
  /// For reports that come once a second: they need a longer silence, and one stranger is enough.
  explicit SenderWatch(time::Duration silence)
      : followed_(silence), contested_(std::max(kContested, silence)), strangers_(1) {}

  /// Adds a message; returns whether it is from the accepted sender.
  [[nodiscard]] bool follow(const Sender& sender, time::SteadyTime now);

  /// Adds a message that is refused for another reason, such as its stamp. It does not show that
  /// its sender is alive, but it may reveal a second sender.
  void refuse(const Sender& sender, time::SteadyTime now);

  /// The accepted sender, while it is alive.
  [[nodiscard]] std::optional<Sender> accepted(time::SteadyTime now) const {
    return followed_.is_alive(now) ? std::optional(followed_.sender()) : std::nullopt;
  }

  /// Whether two senders are alive, or were a moment ago.
  [[nodiscard]] bool is_contested(time::SteadyTime now) const {
    return contested_since_ && now >= *contested_since_ && now < *contested_since_ + contested_;
  }

 private:
  [[nodiscard]] bool are_many_strangers() const {
    return strangers_.full() && strangers_.back() - strangers_.front() < contested_;
  }

  FollowedSender followed_{kSilence};
  time::Duration contested_ = kContested;
  /// When the last messages of strangers came; as many as reveal a second sender.
  boost::circular_buffer<time::SteadyTime> strangers_{kStrangersOfASecondSender};
  std::optional<time::SteadyTime> contested_since_;
};

}  // namespace nodmap::bus
