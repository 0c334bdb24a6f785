// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/time.hpp"

namespace nodmap::node {

/// Accepts the commands of one sender, and detects a second sender.
///
/// The sequence numbers of one sender increase, with small gaps where messages were lost. While the
/// accepted sender is alive, a message whose number does not continue its sequence is from a
/// stranger. A single one may have been duplicated or overtaken on the network. Several within a
/// second, while the accepted sender continues, mean that there are two senders; the numbers do not
/// tell which one is legitimate. A new or restarted sender is accepted once the old one has been
/// silent for kSilence.
///
/// All times must be of one clock; if it steps back, the watch starts again. It does not protect
/// against a sender that is alone, or one that stops the legitimate sender first.
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
  [[nodiscard]] bool follow(std::int64_t seq, time::SteadyTime now);

  /// Whether two senders are alive, or were a moment ago.
  [[nodiscard]] bool is_contested(time::SteadyTime now) const {
    return contested_since_ && now >= *contested_since_ && now < *contested_since_ + kContested;
  }

 private:
  struct Received {
    std::int64_t seq = 0;
    time::SteadyTime at;
  };

  void count_stranger(time::SteadyTime now);

  std::optional<Received> followed_;  // the last message of the accepted sender
  int strangers_ = 0;                 // since the start of the present one-second window
  time::SteadyTime window_begin_;
  std::optional<time::SteadyTime> contested_since_;
};

}  // namespace nodmap::node
