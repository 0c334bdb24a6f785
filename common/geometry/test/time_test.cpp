// SPDX-License-Identifier: BSD-3-Clause
#include "common/geometry/time.hpp"

#include <gtest/gtest.h>

#include <concepts>
#include <limits>

namespace nodmap::time {
namespace time_test {

constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();

template <class A, class B>
concept Comparable = requires(A a, B b) {
  a < b;
};
template <class A, class B>
concept Subtractable = requires(A a, B b) {
  a - b;
};

// The types cannot be confused.
static_assert(Comparable<Timestamp, Timestamp> && Subtractable<Timestamp, Timestamp>);
static_assert(!Comparable<Timestamp, SteadyTime> && !Subtractable<Timestamp, SteadyTime>);
static_assert(!std::convertible_to<Timestamp, SteadyTime>);
static_assert(!std::convertible_to<std::int64_t, Timestamp>);
static_assert(!std::convertible_to<std::int64_t, Duration>);
static_assert(std::same_as<decltype(Timestamp() - Timestamp()), Duration>);
static_assert(sizeof(Timestamp) == sizeof(std::int64_t));

TEST(Time, SecondsAreRoundedToTheNearestMicrosecond) {
  EXPECT_EQ(from_seconds(0.3), 300ms);
  EXPECT_EQ(from_seconds(-0.0000014), -1us);
  EXPECT_EQ(from_seconds(0.0000016), 2us);
  EXPECT_DOUBLE_EQ(seconds(1500ms), 1.5);
  for (const Duration duration : {0us, 1us, 13'320us, -7us, 1'700'000'000'123'457us}) {
    EXPECT_EQ(from_seconds(seconds(duration)), duration);
  }
}

TEST(Time, SecondsOutOfRangeSaturateAndNanIsZero) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double huge_s : {1e300, kInfinity, 2.4e12}) {
    EXPECT_EQ(from_seconds(huge_s), kLimit);
    EXPECT_EQ(from_seconds(-huge_s), -kLimit);
  }
  EXPECT_EQ(from_seconds(std::numeric_limits<double>::quiet_NaN()), 0us);
}

TEST(Time, FineDurationsAreRoundedHalvesAwayFromZero) {
  EXPECT_EQ(rounded(37.0 * FineDuration(1.5)), 56us);
  EXPECT_EQ(rounded(-37.0 * FineDuration(1.5)), -56us);
  EXPECT_EQ(rounded(SteadyTime(1s) + FineDuration(0.4)), SteadyTime(1s));
}

TEST(Time, AMomentGivesTheWallTimeOfASteadyOne) {
  const Moment now{Timestamp(1000s), SteadyTime(3s)};
  EXPECT_EQ(now.wall_at(SteadyTime(2s)), Timestamp(999s));
}

TEST(Time, StampsOfMessagesComeBackAsTheyWere) {
  for (const std::int64_t utime_us : {std::int64_t{0}, std::int64_t{-1}, 1'700'000'000'123'456}) {
    EXPECT_EQ(to_utime(from_utime(utime_us)), utime_us);
    EXPECT_EQ(to_us(from_us(utime_us)), utime_us);
  }
}

TEST(Time, StampsFrom1970ToTheYear38000ArePlausible) {
  EXPECT_TRUE(is_plausible(Timestamp{}));
  EXPECT_FALSE(is_plausible(Timestamp(-1us)));
  EXPECT_TRUE(is_plausible(Timestamp(24h * 365 * 36'000)));
  EXPECT_FALSE(is_plausible(Timestamp(24h * 365 * 37'000)));
  EXPECT_FALSE(is_plausible(from_utime(kMax)));
}

TEST(Time, WhatIsDoneEverySecondIsDueASecondLater) {
  const Timestamp last(100s);
  EXPECT_TRUE(is_due(last, std::nullopt, 1s));
  EXPECT_FALSE(is_due(last + 999ms, last, 1s));
  EXPECT_TRUE(is_due(last + 1s, last, 1s));
  EXPECT_TRUE(is_due(last - 1h, last, 1s)) << "the clock was set back";
}

// Run with UBSan: signed overflow would end the test.
TEST(Time, HostileStampsDoNotOverflow) {
  for (const std::int64_t a_us : {kMin, std::int64_t{0}, kMax}) {
    for (const std::int64_t b_us : {kMin, std::int64_t{0}, kMax}) {
      for (const std::int64_t duration_us : {kMin, std::int64_t{0}, kMax}) {
        const Timestamp a = from_utime(a_us);
        const Timestamp b = from_utime(b_us);
        const Duration duration = from_us(duration_us);
        EXPECT_EQ(a - b > 0us, a_us > b_us);
        EXPECT_EQ(seconds(a + duration - b),
                  seconds(a - b) + seconds(duration));  // powers of two: no rounding
        EXPECT_EQ((a - duration) - b, (a - b) - duration);
      }
    }
  }
}

}  // namespace time_test
}  // namespace nodmap::time
