// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>

namespace nodmap {

using namespace std::chrono_literals;  // a constant is written 300ms

/// Stamps and durations. Outside of this file nobody multiplies by a million: messages, logs and
/// files hold microseconds as 64-bit integers, parameters hold seconds, and both become these types
/// where they are read.
namespace time {

/// Microseconds inside. Write `{}` behind a member or variable: it is not zero by itself.
using Duration = std::chrono::microseconds;
/// For what is no whole number of microseconds: a byte on a line, a degree of a mirror.
using FineDuration = std::chrono::duration<double, std::micro>;

/// The two clocks, as tags: neither can be asked for the time here. Stamps of messages are of the
/// wall clock, which may be set; intervals are measured on the steady clock, which never steps. The
/// difference between stamps of one clock is a Duration; stamps of two clocks do not mix.
struct WallClock {};
struct SteadyClock {};

/// Wall time since the epoch.
using Timestamp = std::chrono::time_point<WallClock, Duration>;
/// Steady time since some moment of its own.
using SteadyTime = std::chrono::time_point<SteadyClock, Duration>;
using FineSteadyTime = std::chrono::time_point<SteadyClock, FineDuration>;

/// One moment on both clocks.
struct Moment {
  Timestamp wall;
  SteadyTime steady;

  /// What the wall clock showed, or will, at another moment, unless it is set in between.
  [[nodiscard]] Timestamp wall_at(SteadyTime other) const { return wall + (other - steady); }
};

/// What comes from outside is brought within this: 73,000 years. A message may say anything; three
/// such values can be added and subtracted without overflow.
inline constexpr Duration kLimit{std::int64_t{1} << 61};

/// Seconds as the numbers of an algorithm.
[[nodiscard]] constexpr double seconds(Duration duration) {
  return 1e-6 * static_cast<double>(duration.count());
}

/// To the nearest microsecond and within kLimit; NaN is no time at all.
[[nodiscard]] inline Duration from_seconds(double duration_s) {
  constexpr double kLimitUs = kLimit.count();  // a power of two: exact
  return Duration(
      std::isnan(duration_s) ? 0 : std::llround(std::clamp(1e6 * duration_s, -kLimitUs, kLimitUs)));
}

/// To the nearest microsecond.
[[nodiscard]] inline Duration rounded(FineDuration duration) {
  return Duration(std::llround(duration.count()));
}
template <class Clock>
[[nodiscard]] std::chrono::time_point<Clock, Duration> rounded(
    std::chrono::time_point<Clock, FineDuration> stamp) {
  return std::chrono::time_point<Clock, Duration>(rounded(stamp.time_since_epoch()));
}

/// A duration of a message, log or file, brought within kLimit.
[[nodiscard]] constexpr Duration from_us(std::int64_t duration_us) {
  return std::clamp(Duration(duration_us), -kLimit, kLimit);
}

/// A duration for a message, log or file.
[[nodiscard]] constexpr std::int64_t to_us(Duration duration) {
  return duration.count();
}

/// The stamp of a message, log or file (`utime`: microseconds since the epoch), brought within
/// kLimit.
[[nodiscard]] constexpr Timestamp from_utime(std::int64_t utime_us) {
  return Timestamp(from_us(utime_us));
}

/// A stamp for a message, log or file.
[[nodiscard]] constexpr std::int64_t to_utime(Timestamp stamp) {
  return stamp.time_since_epoch().count();
}

}  // namespace time
}  // namespace nodmap
