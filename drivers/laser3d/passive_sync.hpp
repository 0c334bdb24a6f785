// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "common/geometry/time.hpp"

namespace nodmap::laser3d {

/// What is known of a device's clock.
struct DeviceClock {
  time::FineDuration tick = 1ms;  ///< nominal
  std::int64_t wrap_ticks = 0;    ///< it counts modulo this
  double max_drift = 0.001;       ///< how far its rate, compared with the host's, may be off
};

/// When something happened, by the host's clock, from the device's own count and the host's stamps,
/// which are late by a latency that varies (Olson 2010, "A passive solution to the sensor
/// synchronization problem").
///
/// Two bounds hold for the host time of an event: it is not later than its own stamp, and not later
/// than that of any earlier event plus the device time between, were the device's clock as slow as
/// it may be. The estimate is the least of them: it follows the smallest latency seen, is never
/// later than the stamp, and forgets a small latency only at the rate of the drift. The constant
/// part of the latency cannot be seen from here and is the caller's to subtract.
class PassiveSync {
 public:
  explicit PassiveSync(const DeviceClock& clock) : clock_(clock) {}

  /// The estimate for an event the device counted at `ticks` (modulo the wrap) and the host
  /// stamped at `stamp`. Events in the order they happened.
  [[nodiscard]] time::SteadyTime to_host(std::int64_t ticks, time::SteadyTime stamp);

  /// Forgets what was learned: the device has been restarted.
  void reset() { started_ = false; }

  /// How often it had to start anew because the clocks no longer fitted.
  [[nodiscard]] std::int64_t restarts() const { return restarts_; }

 private:
  [[nodiscard]] bool no_longer_fits(time::FineDuration late, time::SteadyTime stamp);
  void start(std::int64_t ticks, time::SteadyTime stamp);

  DeviceClock clock_;
  bool started_ = false;
  std::int64_t last_ticks_ = 0;
  time::SteadyTime last_stamp_;
  time::SteadyTime sync_stamp_;        // stamp of the event with the smallest latency
  std::int64_t ticks_since_sync_ = 0;  // device time since then
  time::SteadyTime window_start_;
  time::FineDuration least_late_{};  // in this window
  std::int64_t restarts_ = 0;
};

}  // namespace nodmap::laser3d
