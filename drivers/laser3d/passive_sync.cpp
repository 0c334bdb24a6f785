// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/passive_sync.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::laser3d {
namespace {

// No latency is this long: one of the clocks must have been set.
constexpr time::FineDuration kImpossiblyLate = 250ms;
// No latency stays this long for a whole window.
constexpr time::FineDuration kSuspiciouslyLate = 5ms;
constexpr time::Duration kWindow = 1s;

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

bool PassiveSync::no_longer_fits(time::FineDuration late, time::SteadyTime stamp) {
  if (late > kImpossiblyLate) {
    return true;
  }
  least_late_ = std::min(least_late_, late);
  if (stamp - window_start_ < kWindow) {
    return false;
  }
  const bool suspicious = least_late_ > kSuspiciouslyLate;
  window_start_ = stamp;
  least_late_ = late;
  return suspicious;
}

void PassiveSync::start(std::int64_t ticks, time::SteadyTime stamp) {
  has_started_ = true;
  last_ticks_ = ticks;
  last_stamp_ = stamp;
  sync_stamp_ = stamp;
  ticks_since_sync_ = 0;
  window_start_ = stamp;
  least_late_ = kImpossiblyLate;
}

}  // namespace nodmap::laser3d
