// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/passive_sync.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nodmap::laser3d {
namespace {

// No latency is this long: one of the clocks must have been set.
constexpr time::FineDuration kImpossiblyLate = 250ms;
// No latency stays this long for a whole window. A busy host, which lets this process wait, delays
// some events of a second and not all of them, so that one is on time in every window.
constexpr time::FineDuration kSuspiciouslyLate = 5ms;
constexpr time::Duration kWindow = 1s;
// All events of a window are later than this only if the line delays them: a clock beyond its bound
// (1 % too slow) is 10 ms late after a second, and a USB adapter whose latency timer was changed is
// 16 ms late at most. To believe the stamps of so late a device is dangerous: at 1.8 m/s the robot
// is 4 cm further than an obstacle's place says, and a head that pitches at 100 degrees per second
// points 2 degrees elsewhere.
constexpr time::FineDuration kDelayed = 20ms;

}  // namespace

time::SteadyTime PassiveSync::to_host(std::int64_t ticks, time::SteadyTime stamp) {
  const double silence_ticks = (stamp - last_stamp_) / clock_.tick;
  // After half a period of the counter it is unknown how often it has wrapped.
  if (!has_started_ || stamp < last_stamp_ ||
      silence_ticks > 0.5 * static_cast<double>(clock_.wrap_ticks)) {
    start(ticks, stamp);
    return stamp;
  }
  ticks_since_sync_ += (ticks - last_ticks_ + clock_.wrap_ticks) % clock_.wrap_ticks;
  last_ticks_ = ticks;
  last_stamp_ = stamp;
  const time::FineDuration device_time = static_cast<double>(ticks_since_sync_) * clock_.tick;
  const auto bound = sync_stamp_ + device_time * (1.0 + clock_.max_drift);
  const time::FineDuration late = stamp - bound;
  if (late <= 0us) {
    start(ticks, stamp);
    return stamp;
  }
  if (no_longer_fits(late, stamp)) {
    ++restarts_;
    start(ticks, stamp);
    return stamp;
  }
  return time::rounded(bound);
}

// Whether to start again. Not if the line delays the events: they are held against the clocks as
// they were, until one is on time again, or the line starts anew, or the lateness is impossible.
bool PassiveSync::no_longer_fits(time::FineDuration late, time::SteadyTime stamp) {
  if (late > kImpossiblyLate) {
    return true;
  }
  if (late <= kDelayed) {
    delay_ = {};
  }
  least_late_ = std::min(least_late_, late);
  if (stamp - window_start_ < kWindow) {
    return false;
  }
  const time::FineDuration least = std::exchange(least_late_, late);
  window_start_ = stamp;
  if (least > kDelayed) {
    delay_ = least;
    return false;
  }
  return least > kSuspiciouslyLate;
}

void PassiveSync::start(std::int64_t ticks, time::SteadyTime stamp) {
  has_started_ = true;
  last_ticks_ = ticks;
  last_stamp_ = stamp;
  sync_stamp_ = stamp;
  ticks_since_sync_ = 0;
  window_start_ = stamp;
  least_late_ = kImpossiblyLate;
  delay_ = {};
}

std::string describe_delay(time::FineDuration delay) {
  return "its data arrive " + std::to_string(10 * std::lround(delay / 10ms)) + " ms late";
}

}  // namespace nodmap::laser3d
