// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <chrono>

#include "common/geometry/time.hpp"

namespace nodmap::time {

/// The clock of a shell: for stamping status messages and log events and for pacing, never to know
/// when something was measured (that is in the message).
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

/// For periods and delays: goes on when the wall clock is set.
inline SteadyTime steady_now() {
  return SteadyTime(
      std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch()));
}

/// For a shell whose devices' time must not step with the wall clock.
inline Moment now_on_both_clocks() {
  return {SystemClock().now(), steady_now()};
}

/// Stands where a test puts it.
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
