// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/stop_repeater.hpp"

#include <gtest/gtest.h>

namespace nodmap::kurt {
namespace stop_repeater_test {

constexpr time::Timestamp kWall{1'700'000'000s};
constexpr time::SteadyTime kStart{5s};

time::Moment after(time::Duration duration) {
  return {kWall + duration, kStart + duration};
}

TEST(StopRepeater, RepeatsOnceASecondAndBeginsAnewAfterARelease) {
  StopRepeater repeater;
  int repeated = 0;
  const auto run = [&](const std::optional<std::string>& stopped_by, time::Duration from,
                       time::Duration until) {
    repeated = 0;
    for (time::Duration t = from; t < until; t += 10ms) {
      repeated += repeater.repeat_if_due(stopped_by, after(t)) ? 1 : 0;
    }
    return repeated;
  };
  EXPECT_EQ(run("page", 0ms, 1s), 0);
  EXPECT_EQ(run("page", 1s, 3500ms), 3);  // after 1, 2 and 3 s
  EXPECT_EQ(run({}, 3500ms, 10s), 0);
  EXPECT_EQ(run("page", 10s, 11s), 0);
  EXPECT_EQ(run("page", 11s, 11500ms), 1);
}

// Everything else on STOP must be obeyed.
TEST(StopRepeater, OnlyTheLastRepetitionIsItsOwn) {
  StopRepeater repeater;
  EXPECT_FALSE(repeater.is_own({}));
  EXPECT_FALSE(repeater.repeat_if_due("page", after(0s)));
  const std::optional<nodmap::stop_t> own = repeater.repeat_if_due("page", after(1s));
  ASSERT_TRUE(own);
  EXPECT_TRUE(repeater.is_own(*own));
  nodmap::stop_t release = *own;
  release.is_stopped = 0;
  EXPECT_FALSE(repeater.is_own(release));
  nodmap::stop_t later = *own;
  ++later.utime;
  EXPECT_FALSE(repeater.is_own(later));
  nodmap::stop_t of_another = *own;
  of_another.requested_by = "nodmap-kurt, for another";
  EXPECT_FALSE(repeater.is_own(of_another));
}

}  // namespace stop_repeater_test
}  // namespace nodmap::kurt
