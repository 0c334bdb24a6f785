// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "common/geometry/time.hpp"

namespace nodmap::serial {

/// When to try again what failed: soon after the first time, then at growing distances, so that a
/// device that is gone for the day costs nothing. Pure: the time comes from the caller's clock.
class BackOff {
 public:
  static constexpr time::Duration kFirst = 100ms;
  static constexpr time::Duration kLongest = 5s;

  /// Whether an attempt is due.
  [[nodiscard]] bool due(time::SteadyTime now) const { return now >= next_; }

  /// Time until an attempt is due; 0 when it is.
  [[nodiscard]] time::Duration wait(time::SteadyTime now) const {
    return std::max(next_ - now, time::Duration{});
  }

  /// An attempt has failed.
  void failed(time::SteadyTime now) {
    next_ = now + delay_;
    delay_ = std::min(2 * delay_, kLongest);
  }

  /// What is tried works: the next failure is a first one again.
  void succeeded() {
    delay_ = kFirst;
    next_ = {};
  }

 private:
  time::Duration delay_ = kFirst;
  time::SteadyTime next_;
};

}  // namespace nodmap::serial
