// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <chrono>

#include "common/geometry/time.hpp"

namespace nodmap::time {

/// The clock of a process: to stamp status messages and log events, and for periods. It must not be
/// used to determine when something was measured: that time is in the message.
class Clock : private boost::noncopyable {
 public:
  virtual ~Clock() = default;

  [[nodiscard]] virtual Timestamp now() const = 0;
};

class SystemClock : public Clock {
 public:
  [[nodiscard]] Timestamp now() const override {
    return Timestamp(
        std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch()));
  }
};

/// The present steady time, for periods and delays: not affected when the wall clock is set.
inline SteadyTime steady_now() {
  return SteadyTime(
      std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch()));
}

/// The present moment by two clocks. If the process is interrupted between their readings, a stamp
/// computed from this moment is wrong by as much, and stamps step back. So the steady clock is read
/// before and after the wall clock, and again if the two are not close together.
template <class WallClock, class SteadyClock>
[[nodiscard]] Moment read_together(WallClock wall, SteadyClock steady) {
  constexpr Duration kClose = std::chrono::microseconds(100);
  constexpr int kMaxTries = 3;
  Moment best;
  Duration shortest = Duration::max();
  for (int i = 0; i < kMaxTries && shortest > kClose; ++i) {
    const SteadyTime before = steady();
    const Timestamp stamp = wall();
    const Duration taken = steady() - before;
    if (taken < shortest) {
      shortest = taken;
      best = {stamp, before + taken / 2};
    }
  }
  return best;
}

/// The present moment, for nodes whose device times must not step with the wall clock.
inline Moment now_on_both_clocks() {
  return read_together([] { return SystemClock().now(); }, steady_now);
}

}  // namespace nodmap::time
