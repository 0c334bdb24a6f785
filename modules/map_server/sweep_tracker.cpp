// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/sweep_tracker.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/angle.hpp"

namespace nodmap::map_server {
namespace {

// The smallest step between scans (paper, II).
constexpr double kSmallestStepRad = geometry::deg_to_rad(0.25);
// A reversal is at least this, the resolution of the servo with some jitter.
constexpr double kMinReversalRad = geometry::deg_to_rad(0.2);
// The farthest of some scans and the present one differ by five standard deviations of a scan's
// pitch less than once in a thousand sweeps.
constexpr double kReversalSigmas = 5.0;

// At the smallest step a nodding head is within `reversed_rad` for this many scans at a reversal;
// eight more are not held still yet.
int scans_at_reversal(double reversed_rad) {
  return static_cast<int>(std::ceil(2.0 * reversed_rad / kSmallestStepRad)) + 8;
}

}  // namespace

SweepTracker::SweepTracker(double pitch_sigma_rad)
    : reversed_rad_(std::max(kMinReversalRad, kReversalSigmas * pitch_sigma_rad)),
      most_still_scans_(scans_at_reversal(reversed_rad_)) {}

void SweepTracker::add(double pitch_first_rad, double pitch_last_rad) {
  const auto [low, high] = std::minmax(pitch_first_rad, pitch_last_rad);
  const double pitch = 0.5 * (low + high);
  if (scans_++ == 0) {
    still_rad_ = farthest_rad_ = pitch;
    current_ = {low, high};
  }
  current_ = {std::min(current_.min_rad, low), std::max(current_.max_rad, high)};
  if (std::abs(pitch - still_rad_) > reversed_rad_) {
    still_rad_ = pitch;
    still_scans_ = 0;
  } else if (++still_scans_ > most_still_scans_) {
    farthest_rad_ = pitch;
    direction_ = 0.0;
    finish_sweep({low, high});
    return;
  }
  const double advance = pitch - farthest_rad_;
  if (direction_ == 0.0) {
    direction_ = std::abs(advance) > reversed_rad_ ? std::copysign(1.0, advance) : 0.0;
  }
  if (advance * direction_ > 0.0) {
    farthest_rad_ = pitch;
  } else if (advance * direction_ < -reversed_rad_) {
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
  if (both.min_rad > both.max_rad + reversed_rad_) {
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
