// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/sweep_meter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nodmap::pitch_controller {
namespace {

// Readings come every 5 ms, every 50 ms at worst: after a longer gap a reversal may have been
// missed. If the clock is set back by no more than this, what is left out is no longer a gap
// either.
constexpr time::Duration kGap = 60ms;

}  // namespace

double MeasuredSweep::mean_rate_rad_s(double acceleration_rad_s2) const {
  const double reversal_s = peak_rate_rad_s / acceleration_rad_s2;
  return span.range_rad() / std::max(duration_s - reversal_s, 1e-3);
}

std::optional<MeasuredSweep> SweepMeter::add(const PitchReading& reading) {
  if (newest_ && (reading.stamp < newest_->stamp || reading.sweep < newest_->sweep)) {
    const bool goes_on = reading.sweep >= newest_->sweep && reading.sweep - newest_->sweep <= 1;
    if (goes_on && newest_->stamp - reading.stamp <= kGap) {
      return std::nullopt;  // the clock was set a little
    }
    *this = SweepMeter();
  }
  if (!newest_) {
    begin(reading, false);
    return std::nullopt;
  }
  const bool reversed = reading.sweep != newest_->sweep;
  const bool no_gap = reading.stamp - newest_->stamp <= kGap && reading.sweep - newest_->sweep <= 1;
  present_.is_complete = present_.is_complete && no_gap;
  has_gap_ = has_gap_ || !no_gap;
  extend(reading);
  newest_ = reading;
  if (!reversed) {
    return std::nullopt;
  }
  present_.is_upwards = 2.0 * reading.pitch_rad > present_.span.min_rad + present_.span.max_rad;
  before_last_ = last_;
  last_ = present_;
  had_gap_ = std::exchange(has_gap_, false);
  begin(reading, no_gap);
  return last_;
}

std::optional<MeasuredSweep> SweepMeter::last_two_sweeps() const {
  if (!last_ || !before_last_ || !last_->is_complete || !before_last_->is_complete) {
    return std::nullopt;
  }
  return MeasuredSweep{
      std::max({last_->duration_s, before_last_->duration_s, present_.duration_s}),
      {std::min(last_->span.min_rad, before_last_->span.min_rad),
       std::max(last_->span.max_rad, before_last_->span.max_rad)},
      std::max({last_->peak_rate_rad_s, before_last_->peak_rate_rad_s, present_.peak_rate_rad_s}),
      true,
      false};
}

void SweepMeter::begin(const PitchReading& reading, bool at_its_end) {
  newest_ = reading;
  began_ = reading.stamp;
  present_ = {0.0, {reading.pitch_rad, reading.pitch_rad}, 0.0, at_its_end, false};
  extend(reading);
}

void SweepMeter::extend(const PitchReading& reading) {
  present_.duration_s = time::seconds(reading.stamp - began_);
  present_.span.min_rad = std::min(present_.span.min_rad, reading.pitch_rad);
  present_.span.max_rad = std::max(present_.span.max_rad, reading.pitch_rad);
  present_.peak_rate_rad_s = std::max(present_.peak_rate_rad_s, std::abs(reading.rate_rad_s));
}

}  // namespace nodmap::pitch_controller
