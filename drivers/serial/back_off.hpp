// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>

namespace nodmap::serial {

/// When to try again what failed: soon after the first time, then at growing distances, so that a
/// device that is gone for the day costs nothing. Pure: the time comes from the caller's clock.
class BackOff {
 public:
  static constexpr std::int64_t kFirstUs = 100'000;
  static constexpr std::int64_t kLongestUs = 5'000'000;

  /// Whether an attempt is due.
  [[nodiscard]] bool due(std::int64_t now_us) const { return now_us >= next_us_; }

  /// Time until an attempt is due, microseconds; 0 when it is.
  [[nodiscard]] std::int64_t wait_us(std::int64_t now_us) const {
    return std::max<std::int64_t>(0, next_us_ - now_us);
  }

  /// An attempt has failed.
  void failed(std::int64_t now_us) {
    next_us_ = now_us + delay_us_;
    delay_us_ = std::min(2 * delay_us_, kLongestUs);
  }

  /// What is tried works: the next failure is a first one again.
  void succeeded() {
    delay_us_ = kFirstUs;
    next_us_ = 0;
  }

 private:
  std::int64_t delay_us_ = kFirstUs;
  std::int64_t next_us_ = 0;
};

}  // namespace nodmap::serial
