// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/sweep_meter.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::pitch_controller {
namespace {

// Readings come every 5 ms, every 50 ms at worst: beyond, a turn may have gone by.
constexpr std::int64_t kGapUs = 60'000;

}  // namespace

std::optional<MeasuredSweep> SweepMeter::add(const PitchReading& reading) {
  if (newest_ && (reading.time_us < newest_->time_us || reading.sweep < newest_->sweep)) {
    *this = SweepMeter();
  }
  if (!newest_) {
    begin(reading, false);
    return std::nullopt;
  }
  const bool turned = reading.sweep != newest_->sweep;
  const bool seen =
      reading.time_us - newest_->time_us <= kGapUs && reading.sweep - newest_->sweep <= 1;
  current_.is_whole = current_.is_whole && seen;
  extend(reading);
  newest_ = reading;
  if (!turned) {
    return std::nullopt;
  }
  before_last_ = last_;
  last_ = current_;
  begin(reading, seen);
  return last_;
}

std::optional<MeasuredSweep> SweepMeter::period() const {
  if (!last_ || !before_last_ || !last_->is_whole || !before_last_->is_whole) {
    return std::nullopt;
  }
  return MeasuredSweep{
      std::max({last_->duration_s, before_last_->duration_s, current_.duration_s}),
      {std::min(last_->span.min_rad, before_last_->span.min_rad),
       std::max(last_->span.max_rad, before_last_->span.max_rad)},
      std::max({last_->peak_rate_rad_s, before_last_->peak_rate_rad_s, current_.peak_rate_rad_s}),
      true};
}

void SweepMeter::begin(const PitchReading& reading, bool at_its_end) {
  newest_ = reading;
  began_us_ = reading.time_us;
  current_ = {0.0, {reading.pitch_rad, reading.pitch_rad}, 0.0, at_its_end};
  extend(reading);
}

void SweepMeter::extend(const PitchReading& reading) {
  current_.duration_s = 1e-6 * static_cast<double>(reading.time_us - began_us_);
  current_.span.min_rad = std::min(current_.span.min_rad, reading.pitch_rad);
  current_.span.max_rad = std::max(current_.span.max_rad, reading.pitch_rad);
  current_.peak_rate_rad_s = std::max(current_.peak_rate_rad_s, std::abs(reading.rate_rad_s));
}

}  // namespace nodmap::pitch_controller
