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

/// The present moment, for nodes whose device times must not step with the wall clock.
inline Moment now_on_both_clocks() {
  return {SystemClock().now(), steady_now()};
}

/// A clock that shows the time that a test sets.
class ManualClock : public Clock {
 public:
  explicit ManualClock(Timestamp now) : now_(now) {}
  [[nodiscard]] Timestamp now() const override { return now_; }
  void set(Timestamp now) { now_ = now; }
  void advance(Duration duration) { now_ += duration; }

 private:
  Timestamp now_;
};

}  // namespace nodmap::time
