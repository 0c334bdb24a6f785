// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "common/geometry/time.hpp"

namespace nodmap::laser3d {

/// The properties of a device's clock.
struct DeviceClock {
  time::FineDuration tick = 1ms;  ///< nominal
  std::int64_t wrap_ticks = 0;    ///< the counter counts modulo this
  double max_drift = 0.001;       ///< greatest relative error of its rate, compared with the host's
};

/// Computes when an event happened on the host's clock, from the device's own counter and the
/// host's stamps, which are late by a varying latency (Olson 2010, "A passive solution to the
/// sensor synchronization problem").
///
/// The host time of an event has two bounds: it is not later than its own stamp, and not later than
/// the stamp of any earlier event plus the device time in between, for the slowest permitted device
/// clock. The estimate is the smallest of these: it follows the smallest latency observed, is never
/// later than the stamp, and forgets a small latency only at the rate of the drift. The constant
/// part of the latency cannot be observed; the caller must subtract it.
///
/// When all events of a second are late by more than 20 ms, the line delays them. The estimates
/// then stay those of the clocks before the delay, so that readers see how old the events are. It
/// ends with the first event that is on time.
class PassiveSync {
 public:
  explicit PassiveSync(const DeviceClock& clock) : clock_(clock) {}

  /// The estimate for an event with the device count `ticks` (modulo the wrap) and the host stamp
  /// `stamp`. Events must be given in their order.
  [[nodiscard]] time::SteadyTime to_host(std::int64_t ticks, time::SteadyTime stamp);

  /// Starts again, because the device has been restarted.
  void reset() {
    has_started_ = false;
    delay_ = {};
  }

  /// By how much the line delays all events; 0 if it does not.
  [[nodiscard]] time::FineDuration delay() const { return delay_; }

  /// How often it has started again because the clocks no longer agreed.
  [[nodiscard]] std::int64_t restarts() const { return restarts_; }

 private:
  [[nodiscard]] bool no_longer_fits(time::FineDuration late, time::SteadyTime stamp);
  void start(std::int64_t ticks, time::SteadyTime stamp);

  DeviceClock clock_;
  bool has_started_ = false;
  std::int64_t last_ticks_ = 0;
  time::SteadyTime last_stamp_;
  time::SteadyTime sync_stamp_;        // stamp of the event with the smallest latency
  std::int64_t ticks_since_sync_ = 0;  // device time since then
  time::SteadyTime window_start_;
  time::FineDuration least_late_{};  // in this window
  time::FineDuration delay_{};
  std::int64_t restarts_ = 0;
};

/// Says so, in tens of milliseconds, so that the text does not change with every scan.
[[nodiscard]] std::string describe_delay(time::FineDuration delay);

}  // namespace nodmap::laser3d
