// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/encoder_clock.hpp"

#include <algorithm>

namespace nodmap::kurt {
namespace {

/// The estimate runs ahead by a thousandth, more than two quartz clocks ever differ, so that it
/// keeps touching the least delay instead of falling behind a base that runs slow.
constexpr time::Duration kStep = kEncoderPeriod + kEncoderPeriod / 1000;
constexpr int kWindowFrames = 50;
/// Between jitter that happens to last (0) and one lost frame (1 period).
constexpr time::Duration kLost = kEncoderPeriod * 7 / 10;
/// The base stops when it hears nothing for 100 ms: over a longer silence "drove on as before" is
/// no good guess.
constexpr time::Duration kGap = 100ms;

}  // namespace

EncoderClock::Reading EncoderClock::take(time::SteadyTime arrival) {
  if (!started_ || arrival - measured_ > kGap) {
    return begin(arrival);
  }
  measured_ = std::min(measured_ + kStep, arrival);
  const int lost = lost_in_window(arrival);
  told_ = std::max(measured_, told_ + 1us);
  return {told_, lost, {}};
}

EncoderClock::Reading EncoderClock::begin(time::SteadyTime arrival) {
  const time::Duration gap = begun_before_ ? arrival - told_ : 0us;
  started_ = true;
  begun_before_ = true;
  measured_ = arrival;
  told_ = std::max(arrival, told_ + 1us);
  least_late_ = time::Duration::max();
  in_window_ = 0;
  return {told_, 0, std::max(gap, time::Duration{})};
}

int EncoderClock::lost_in_window(time::SteadyTime arrival) {
  least_late_ = std::min(least_late_, arrival - measured_);
  if (++in_window_ < kWindowFrames) {
    return 0;
  }
  int lost = 0;
  if (least_late_ >= kLost) {
    lost = static_cast<int>((least_late_ + kEncoderPeriod / 2) / kEncoderPeriod);
    measured_ = std::min(measured_ + lost * kEncoderPeriod, arrival);
  }
  least_late_ = time::Duration::max();
  in_window_ = 0;
  return lost;
}

}  // namespace nodmap::kurt
