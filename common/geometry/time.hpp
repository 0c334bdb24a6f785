// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>

namespace nodmap {

using namespace std::chrono_literals;  // a constant is written 300ms

/// Types for stamps and durations. Messages, logs and files contain microseconds as 64-bit
/// integers, parameters contain seconds; both are converted to these types where they are read, so
/// that no other code needs factors of a million.
namespace time {

/// Stores microseconds. Initialise members and variables with `{}`: the default is not zero.
using Duration = std::chrono::microseconds;
/// For durations that are not a whole number of microseconds: of a byte on a serial line, of a
/// degree of the mirror.
using FineDuration = std::chrono::duration<double, std::micro>;

/// The two clocks, as tags without a now(). Stamps of messages are on the wall clock, which may be
/// set; intervals are measured on the steady clock, which never steps. The difference of two times
/// on the same clock is a Duration; times on different clocks cannot be mixed.
struct WallClock {};
struct SteadyClock {};

/// Wall time since the epoch.
using Timestamp = std::chrono::time_point<WallClock, Duration>;
/// Steady time since an arbitrary moment.
using SteadyTime = std::chrono::time_point<SteadyClock, Duration>;
using FineSteadyTime = std::chrono::time_point<SteadyClock, FineDuration>;

/// One moment on both clocks.
struct Moment {
  Timestamp wall;
  SteadyTime steady;

  /// The wall-clock time at another steady time, provided that the wall clock is not set in
  /// between.
  [[nodiscard]] Timestamp wall_at(SteadyTime other) const { return wall + (other - steady); }
};

/// Times read from outside are limited to this, 73,000 years, because a message may contain any
/// number. Three such values can be added and subtracted without overflow.
inline constexpr Duration kLimit{std::int64_t{1} << 61};

/// Converts to seconds, for the computations of an algorithm.
[[nodiscard]] constexpr double seconds(Duration duration) {
  return 1e-6 * static_cast<double>(duration.count());
}

/// The quotient of two durations; the second is not zero.
[[nodiscard]] constexpr double ratio(Duration part, Duration whole) {
  return static_cast<double>(part.count()) / static_cast<double>(whole.count());
}

/// Rounds to the nearest microsecond; limited to kLimit. NaN becomes zero.
[[nodiscard]] inline Duration from_seconds(double duration_s) {
  constexpr auto kLimitUs = static_cast<double>(kLimit.count());  // a power of two: exact
  return Duration(
      std::isnan(duration_s) ? 0 : std::llround(std::clamp(1e6 * duration_s, -kLimitUs, kLimitUs)));
}

/// Rounds to the nearest microsecond.
[[nodiscard]] inline Duration rounded(FineDuration duration) {
  return Duration(std::llround(duration.count()));
}
template <class Clock>
[[nodiscard]] std::chrono::time_point<Clock, Duration> rounded(
    std::chrono::time_point<Clock, FineDuration> stamp) {
  return std::chrono::time_point<Clock, Duration>(rounded(stamp.time_since_epoch()));
}

/// Converts a duration of a message, log or file; limited to kLimit.
[[nodiscard]] constexpr Duration from_us(std::int64_t duration_us) {
  return std::clamp(Duration(duration_us), -kLimit, kLimit);
}

/// Converts a duration to that of a message, log or file.
[[nodiscard]] constexpr std::int64_t to_us(Duration duration) {
  return duration.count();
}

/// Converts the stamp of a message, log or file (`utime`: microseconds since the epoch); limited to
/// kLimit.
[[nodiscard]] constexpr Timestamp from_utime(std::int64_t utime_us) {
  return Timestamp(from_us(utime_us));
}

/// Converts a stamp to that of a message, log or file.
[[nodiscard]] constexpr std::int64_t to_utime(Timestamp stamp) {
  return stamp.time_since_epoch().count();
}

/// Whether a stamp is from 1970 to the year 38000. Sums and differences of such stamps never
/// overflow.
[[nodiscard]] constexpr bool is_plausible(Timestamp stamp) {
  return stamp >= Timestamp{} && stamp < Timestamp(kLimit / 2);
}

/// Whether what was done at `last`, and is done every `period`, is to be done again. The magnitude
/// of the difference counts: a clock that is set back must not silence anybody.
[[nodiscard]] constexpr bool is_due(Timestamp now, const std::optional<Timestamp>& last,
                                    Duration period) {
  return !last || std::chrono::abs(now - *last) >= period;
}

}  // namespace time
}  // namespace nodmap
