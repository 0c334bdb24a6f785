// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/passive_sync.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::laser3d {
namespace {

// No latency is as long as this: one of the clocks has been set.
constexpr double kImpossiblyLateUs = 250'000.0;
// And none is this long for a whole window.
constexpr double kSuspiciouslyLateUs = 5'000.0;
constexpr std::int64_t kWindowUs = 1'000'000;

}  // namespace

std::int64_t PassiveSync::to_host_us(std::int64_t ticks, std::int64_t host_us) {
  const double silence_ticks = static_cast<double>(host_us - last_host_us_) / clock_.tick_us;
  // After half a round of the counter nobody knows how often it has wrapped.
  if (!started_ || host_us < last_host_us_ ||
      silence_ticks > 0.5 * static_cast<double>(clock_.wrap_ticks)) {
    start(ticks, host_us);
    return host_us;
  }
  ticks_since_sync_ += (ticks - last_ticks_ + clock_.wrap_ticks) % clock_.wrap_ticks;
  last_ticks_ = ticks;
  last_host_us_ = host_us;
  const double device_us = static_cast<double>(ticks_since_sync_) * clock_.tick_us;
  const double bound_us = static_cast<double>(sync_host_us_) + device_us * (1.0 + clock_.max_drift);
  const double late_us = static_cast<double>(host_us) - bound_us;
  if (late_us <= 0.0) {
    start(ticks, host_us);
    return host_us;
  }
  if (no_longer_fits(late_us, host_us)) {
    ++restarts_;
    start(ticks, host_us);
    return host_us;
  }
  return std::llround(bound_us);
}

bool PassiveSync::no_longer_fits(double late_us, std::int64_t host_us) {
  if (late_us > kImpossiblyLateUs) {
    return true;
  }
  least_late_us_ = std::min(least_late_us_, late_us);
  if (host_us - window_start_us_ < kWindowUs) {
    return false;
  }
  const bool suspicious = least_late_us_ > kSuspiciouslyLateUs;
  window_start_us_ = host_us;
  least_late_us_ = late_us;
  return suspicious;
}

void PassiveSync::start(std::int64_t ticks, std::int64_t host_us) {
  started_ = true;
  last_ticks_ = ticks;
  last_host_us_ = host_us;
  sync_host_us_ = host_us;
  ticks_since_sync_ = 0;
  window_start_us_ = host_us;
  least_late_us_ = kImpossiblyLateUs;
}

}  // namespace nodmap::laser3d
