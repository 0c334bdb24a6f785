// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/sweep_tracker.hpp"

#include <cmath>

#include "common/geometry/angle.hpp"

namespace nodmap::map_server {
namespace {

// More than the jitter of the servo, less than the slowest nod's step (0.25 degrees a scan, II).
constexpr double kTurned = geometry::deg_to_rad(0.2);
// The slowest nod is beyond kTurned after one scan, or two at a turning point.
constexpr int kStillScans = 10;

}  // namespace

void SweepTracker::add(double pitch_first_rad, double pitch_last_rad) {
  const auto [low, high] = std::minmax(pitch_first_rad, pitch_last_rad);
  const double pitch = 0.5 * (low + high);
  if (scans_++ == 0) {
    still_rad_ = farthest_rad_ = pitch;
    current_ = {low, high};
  }
  current_ = {std::min(current_.low_rad, low), std::max(current_.high_rad, high)};
  if (std::abs(pitch - still_rad_) > kTurned) {
    still_rad_ = pitch;
    still_scans_ = 0;
  } else if (++still_scans_ > kStillScans) {
    farthest_rad_ = pitch;
    direction_ = 0.0;
    finish_pass({low, high});
    return;
  }
  const double advance = pitch - farthest_rad_;
  if (direction_ == 0.0) {
    direction_ = std::abs(advance) > kTurned ? std::copysign(1.0, advance) : 0.0;
  }
  if (advance * direction_ > 0.0) {
    farthest_rad_ = pitch;
  } else if (advance * direction_ < -kTurned) {
    finish_pass({std::min(farthest_rad_, low), std::max(farthest_rad_, high)});
    farthest_rad_ = pitch;
    direction_ = -direction_;
  }
}

std::optional<PitchInterval> SweepTracker::wedge() const {
  if (!last_ || !before_last_) {
    return std::nullopt;
  }
  const PitchInterval both{std::max(last_->low_rad, before_last_->low_rad),
                           std::min(last_->high_rad, before_last_->high_rad)};
  // Two scans of a scanner that holds still differ by its jitter: no wedge in common, but a line.
  if (both.low_rad > both.high_rad + kTurned) {
    return std::nullopt;
  }
  return PitchInterval{std::min(both.low_rad, both.high_rad),
                       std::max(both.low_rad, both.high_rad)};
}

void SweepTracker::finish_pass(PitchInterval next) {
  before_last_ = last_;
  last_ = current_;
  current_ = next;
  ++pass_;
}

}  // namespace nodmap::map_server
