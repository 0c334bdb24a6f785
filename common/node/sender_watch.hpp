// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/time.hpp"

namespace nodmap::node {

/// Follows one sender of commands, and notices a second one.
///
/// The numbers of one sender go up, with small gaps where messages were lost. While the sender is
/// alive, a message whose number does not continue its sequence is a stranger's. One stranger may
/// be a message that was duplicated or overtaken on the network. Several within a second, while the
/// sender that is followed goes on, are two senders at once; which of them is the right one cannot
/// be known from the numbers. A sender that starts anew is followed as soon as the former has been
/// silent for kSilence.
///
/// Times are of one clock; when it is set back, what was heard before is forgotten.
/// Not protected against: a sender that is alone, and one that stops the right sender first.
class SenderWatch {
 public:
  /// A sender that is silent for so long is gone, and another may be followed.
  static constexpr time::Duration kSilence = 200ms;
  /// More messages cannot be lost from a sender that is alive: 0.2 s of 500 a second.
  static constexpr std::int64_t kLargestStep = 100;
  /// So many strangers in a second are no accident of the network.
  static constexpr int kStrangersOfASecondSender = 3;
  /// So long after two senders were last heard they count as two.
  static constexpr time::Duration kContested = 1s;

  /// A message has come. Whether it is of the sender that is followed.
  [[nodiscard]] bool follow(std::int64_t seq, time::SteadyTime now);

  /// Whether two senders are alive, or were a moment ago.
  [[nodiscard]] bool is_contested(time::SteadyTime now) const {
    return contested_since_ && now >= *contested_since_ && now < *contested_since_ + kContested;
  }

 private:
  struct Heard {
    std::int64_t seq = 0;
    time::SteadyTime at;
  };

  void count_stranger(time::SteadyTime now);

  std::optional<Heard> followed_;  // the last message of the sender that is followed
  int strangers_ = 0;              // since the begin of this window of a second
  time::SteadyTime window_begin_;
  std::optional<time::SteadyTime> contested_since_;
};

}  // namespace nodmap::node
