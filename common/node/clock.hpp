// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <chrono>
#include <cstdint>

#include "common/geometry/time.hpp"

namespace nodmap::time {

/// The clock of a shell: for stamping status messages and log events and for pacing, never to know
/// when something was measured (that is in the message).
class Clock : private boost::noncopyable {
 public:
  virtual ~Clock() = default;

  /// Microseconds since the epoch.
  [[nodiscard]] virtual std::int64_t now_utime_us() const = 0;
};

class SystemClock : public Clock {
 public:
  [[nodiscard]] std::int64_t now_utime_us() const override {
    return std::chrono::duration_cast<std::chrono::microseconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
  }
};

/// For a shell whose devices' time must not step with the wall clock.
inline Moment now_on_both_clocks() {
  return {from_utime(SystemClock().now_utime_us()),
          SteadyTime(std::chrono::duration_cast<Duration>(
              std::chrono::steady_clock::now().time_since_epoch()))};
}

/// Stands where a test puts it.
class ManualClock : public Clock {
 public:
  explicit ManualClock(std::int64_t utime_us) : utime_us_(utime_us) {}
  [[nodiscard]] std::int64_t now_utime_us() const override { return utime_us_; }
  void set(std::int64_t utime_us) { utime_us_ = utime_us; }
  void advance(std::int64_t duration_us) { utime_us_ += duration_us; }

 private:
  std::int64_t utime_us_;
};

}  // namespace nodmap::time
