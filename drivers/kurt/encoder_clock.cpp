// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/encoder_clock.hpp"

#include <algorithm>
#include <limits>

namespace nodmap::kurt {
namespace {

/// The estimate runs ahead by a thousandth, more than two quartz clocks ever differ, so that it
/// keeps touching the least delay instead of falling behind a base that runs slow.
constexpr std::int64_t kStepUs = kEncoderPeriodUs + kEncoderPeriodUs / 1000;
constexpr int kWindowFrames = 50;
/// Between jitter that happens to last (0) and one lost frame (1 period).
constexpr std::int64_t kLostUs = kEncoderPeriodUs * 7 / 10;
/// The base stops when it hears nothing for 100 ms: over a longer silence "drove on as before" is
/// no good guess.
constexpr std::int64_t kGapUs = 100'000;

}  // namespace

EncoderClock::Reading EncoderClock::take(std::int64_t arrival_us) {
  if (!started_ || arrival_us - measured_us_ > kGapUs) {
    return begin(arrival_us);
  }
  measured_us_ = std::min(measured_us_ + kStepUs, arrival_us);
  const int lost = lost_in_window(arrival_us);
  told_us_ = std::max(measured_us_, told_us_ + 1);
  return {told_us_, lost, 0};
}

EncoderClock::Reading EncoderClock::begin(std::int64_t arrival_us) {
  const std::int64_t gap_us = begun_before_ ? arrival_us - told_us_ : 0;
  started_ = true;
  begun_before_ = true;
  measured_us_ = arrival_us;
  told_us_ = std::max(arrival_us, told_us_ + 1);
  least_late_us_ = std::numeric_limits<std::int64_t>::max();
  in_window_ = 0;
  return {told_us_, 0, std::max<std::int64_t>(gap_us, 0)};
}

int EncoderClock::lost_in_window(std::int64_t arrival_us) {
  least_late_us_ = std::min(least_late_us_, arrival_us - measured_us_);
  if (++in_window_ < kWindowFrames) {
    return 0;
  }
  int lost = 0;
  if (least_late_us_ >= kLostUs) {
    lost = static_cast<int>((least_late_us_ + kEncoderPeriodUs / 2) / kEncoderPeriodUs);
    measured_us_ = std::min(measured_us_ + lost * kEncoderPeriodUs, arrival_us);
  }
  least_late_us_ = std::numeric_limits<std::int64_t>::max();
  in_window_ = 0;
  return lost;
}

}  // namespace nodmap::kurt
