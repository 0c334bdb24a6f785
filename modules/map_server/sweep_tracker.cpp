// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/sweep_tracker.hpp"

#include <cmath>

#include "common/geometry/angle.hpp"

namespace nodmap::map_server {
namespace {

// More than the jitter of the servo, less than the smallest step between scans (0.25 degrees;
// paper, II).
constexpr double kReversedRad = geometry::deg_to_rad(0.2);
// The head is held still when its pitch stays within kReversedRad for this many scans. At the
// smallest step a nodding head leaves this interval after one scan, or two at a reversal.
constexpr int kStillScans = 10;

}  // namespace

void SweepTracker::add(double pitch_first_rad, double pitch_last_rad) {
  const auto [low, high] = std::minmax(pitch_first_rad, pitch_last_rad);
  const double pitch = 0.5 * (low + high);
  if (scans_++ == 0) {
    still_rad_ = farthest_rad_ = pitch;
    current_ = {low, high};
  }
  current_ = {std::min(current_.min_rad, low), std::max(current_.max_rad, high)};
  if (std::abs(pitch - still_rad_) > kReversedRad) {
    still_rad_ = pitch;
    still_scans_ = 0;
  } else if (++still_scans_ > kStillScans) {
    farthest_rad_ = pitch;
    direction_ = 0.0;
    finish_sweep({low, high});
    return;
  }
  const double advance = pitch - farthest_rad_;
  if (direction_ == 0.0) {
    direction_ = std::abs(advance) > kReversedRad ? std::copysign(1.0, advance) : 0.0;
  }
  if (advance * direction_ > 0.0) {
    farthest_rad_ = pitch;
  } else if (advance * direction_ < -kReversedRad) {
    finish_sweep({std::min(farthest_rad_, low), std::max(farthest_rad_, high)});
    farthest_rad_ = pitch;
    direction_ = -direction_;
  }
}

std::optional<PitchInterval> SweepTracker::covered() const {
  if (!last_ || !before_last_) {
    return std::nullopt;
  }
  const PitchInterval both{std::max(last_->min_rad, before_last_->min_rad),
                           std::min(last_->max_rad, before_last_->max_rad)};
  // The scans of a head that is held still differ by its jitter, so the intervals may not overlap.
  if (both.min_rad > both.max_rad + kReversedRad) {
    return std::nullopt;
  }
  return PitchInterval{std::min(both.min_rad, both.max_rad), std::max(both.min_rad, both.max_rad)};
}

void SweepTracker::finish_sweep(PitchInterval next) {
  before_last_ = last_;
  last_ = current_;
  current_ = next;
  ++sweep_;
}

}  // namespace nodmap::map_server
