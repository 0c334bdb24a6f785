// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "common/geometry/time.hpp"

namespace nodmap::serial {

/// Decides when to retry: soon after the first failure, then after growing pauses, so that a device
/// that is absent for long costs nothing. It has no clock of its own.
class BackOff {
 public:
  static constexpr time::Duration kFirst = 100ms;
  static constexpr time::Duration kLongest = 5s;

  explicit BackOff(time::Duration longest = kLongest) : longest_(longest) {}

  /// Whether an attempt is due.
  [[nodiscard]] bool due(time::SteadyTime now) const { return now >= next_; }

  /// Time until an attempt is due; 0 when it is.
  [[nodiscard]] time::Duration wait(time::SteadyTime now) const {
    return std::max(next_ - now, time::Duration{});
  }

  /// To be called when an attempt has failed.
  void failed(time::SteadyTime now) {
    next_ = now + delay_;
    delay_ = std::min(2 * delay_, longest_);
  }

  /// To be called when an attempt has succeeded: the next failure counts as the first again.
  void succeeded() {
    delay_ = kFirst;
    next_ = {};
  }

 private:
  time::Duration longest_;
  time::Duration delay_ = kFirst;
  time::SteadyTime next_;
};

}  // namespace nodmap::serial
