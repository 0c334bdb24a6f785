// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/bus/sender.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::node {

/// Accepts the messages of one sender, and detects a second sender.
///
/// While the accepted sender is alive, a message from another socket is from a stranger, whatever
/// its number. Where sockets are not known, the sequence numbers tell: those of one sender
/// increase, with small gaps where messages were lost, so a message whose number does not continue
/// the sequence is from a stranger, too. A single one may have been duplicated or overtaken on the
/// network. Several within a second mean that there are two senders; which one is legitimate is not
/// known. That is certain at once if the accepted sender has skipped their numbers: a second sender
/// has listened and jumped ahead. Otherwise it is certain only when the accepted sender continues,
/// because a process that has restarted has a new socket and counts from 0. A new or restarted
/// sender is accepted once the old one has been silent for kSilence.
///
/// All times must be of one clock; if it steps back, the watch starts again. It does not protect
/// against a sender that is alone or that stops the legitimate sender first, nor, where sockets are
/// not known, against one that jumps ahead for less than kStrangersOfASecondSender messages a
/// second.
class SenderWatch {
 public:
  /// After this much silence the accepted sender is considered gone, and another may be accepted.
  static constexpr time::Duration kSilence = 200ms;
  /// Largest gap in the numbers of a living sender: 0.2 s at 500 messages per second.
  static constexpr std::int64_t kLargestStep = 100;
  /// This many strangers in a second cannot be duplicates or reordering by the network.
  static constexpr int kStrangersOfASecondSender = 3;
  /// How long after the last conflict two senders are still assumed.
  static constexpr time::Duration kContested = 1s;

  /// Adds a message; returns whether it is from the accepted sender.
  [[nodiscard]] bool follow(std::int64_t seq, time::SteadyTime now, const bus::Sender& sender = {});

  /// Adds a message that is refused for another reason, such as its stamp. It does not continue the
  /// sequence, but several may reveal a second sender: after each of them, lower numbers follow.
  void refuse(std::int64_t seq, time::SteadyTime now, const bus::Sender& sender = {});

  /// Whether two senders are alive, or were a moment ago.
  [[nodiscard]] bool is_contested(time::SteadyTime now) const {
    return contested_since_ && now >= *contested_since_ && now < *contested_since_ + kContested;
  }

 private:
  struct Received {
    std::int64_t seq = 0;
    time::SteadyTime at;
    bus::Sender sender;
  };

  [[nodiscard]] bool is_alive(time::SteadyTime now);
  [[nodiscard]] bool is_next(std::int64_t seq, const bus::Sender& sender) const;
  void refuse_stranger(std::int64_t seq, time::SteadyTime now);
  void count_stranger(time::SteadyTime now);
  void contest_if_several(time::SteadyTime now);

  std::optional<Received> followed_;  // the last message of the accepted sender
  // Numbers were skipped after this one. It is kept until none has been skipped for a second, so
  // that a second jump ahead does not hide the first.
  std::int64_t skipped_after_ = 0;
  time::SteadyTime skipped_at_;          // when numbers were skipped last
  std::optional<std::int64_t> refused_;  // greatest number refused since the last message
  int strangers_ = 0;                    // since the start of the present one-second window
  time::SteadyTime window_begin_;
  std::optional<time::SteadyTime> contested_since_;
};

}  // namespace nodmap::node
