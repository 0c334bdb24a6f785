// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/encoder_clock.hpp"

#include <algorithm>
#include <utility>

#include "drivers/kurt/kurt_frames.hpp"

namespace nodmap::kurt {
namespace {

// The estimate advances by 0.1 % more than the nominal period, which is more than two quartz
// clocks differ. So it always catches up with the frames of smallest delay, even if the base's
// clock is slow.
constexpr time::Duration kStep = kEncoderPeriod + kEncoderPeriod / 1000;
constexpr int kWindowFrames = 50;
// A threshold between persistent jitter (0) and one lost frame (1 period).
constexpr time::Duration kLost = kEncoderPeriod * 7 / 10;
// After a longer silence the base may have stopped by itself: it cannot be assumed that the robot
// drove on as before.
constexpr time::Duration kGap = kBaseTimeout;
// Stamps should not lag more than this behind the measurements, because DRIVE carries them and is
// obeyed for 200 ms only. At a greater delay the window ends as soon as it has so many frames.
constexpr time::Duration kMaxLag = 100ms;
constexpr int kMinFrames = 10;

}  // namespace

EncoderClock::Reading EncoderClock::take(time::SteadyTime arrival) {
  const time::Duration silence = arrival - std::exchange(last_arrival_, arrival);
  if (!started_ || silence > kGap) {
    return begin(arrival);
  }
  measured_ = std::min(measured_ + kStep, arrival);
  const int lost = lost_in_window(arrival);
  told_ = std::max(measured_, told_ + 1us);
  return {told_, lost, {}};
}

EncoderClock::Reading EncoderClock::begin(time::SteadyTime arrival) {
  const time::Duration gap = std::exchange(started_, true) ? arrival - told_ : 0us;
  measured_ = arrival;
  told_ = arrival;
  least_late_ = time::Duration::max();
  in_window_ = 0;
  return {told_, 0, gap};
}

int EncoderClock::lost_in_window(time::SteadyTime arrival) {
  const time::Duration late = arrival - measured_;
  least_late_ = std::min(least_late_, late);
  if (++in_window_ < (late > kMaxLag ? kMinFrames : kWindowFrames)) {
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
