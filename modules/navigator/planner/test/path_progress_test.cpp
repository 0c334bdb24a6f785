// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/path_progress.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace nodmap::navigator {
namespace path_progress_test {

constexpr time::Duration kPeriod = 25ms;

// Where the robot is and what is left of its path, after a time.
struct Progress {
  Eigen::Vector2d p_map;
  double cost_m = 0.0;
};

// The first time at which the path is given up, of `lasts`; empty if it never is.
std::optional<time::Duration> given_up_after(
    time::Duration lasts, const std::function<Progress(time::Duration)>& progress_after) {
  PathProgress path_progress;
  for (time::Duration after{0}; after <= lasts; after += kPeriod) {
    const Progress progress = progress_after(after);
    if (path_progress.gives_up(time::Timestamp{100s} + after, progress.p_map, progress.cost_m)) {
      return after;
    }
  }
  return std::nullopt;
}

TEST(PathProgress, WithoutProgressThePathIsGivenUpAfterItsTime) {
  const auto given_up = given_up_after(20s, [](time::Duration) {
    return Progress{{1.0, 0.0}, 8.0};
  });
  ASSERT_TRUE(given_up);
  EXPECT_EQ(*given_up, PathProgress::kPatience);
}

// At 2 cm/s, more slowly than it ever creeps.
TEST(PathProgress, ASlowRobotGoesOn) {
  EXPECT_FALSE(given_up_after(100s, [](time::Duration after) {
    const double driven_m = 0.02 * time::seconds(after);
    return Progress{{driven_m, 0.0}, 8.0 - driven_m};
  }));
}

// It has driven for 10 s towards a gap when that turns out to be closed.
TEST(PathProgress, ALongerPathHasItsOwnTime) {
  const auto given_up = given_up_after(40s, [](time::Duration after) {
    const bool is_closed = after > 10s;
    return Progress{{0.0, 0.0}, is_closed ? 11.0 : 8.0};
  });
  ASSERT_TRUE(given_up);
  EXPECT_EQ(*given_up, 10s + kPeriod + PathProgress::kPatience);
}

// A gap looks wide enough from here and too narrow from there, 10 cm back. The path through it, the
// shorter one, is the wrong one.
TEST(PathProgress, TwoPathsThatAlternateAreNoProgress) {
  const auto is_short = [](time::Duration after) { return (after / 1s) % 3 < 2; };
  const auto given_up = given_up_after(40s, [&](time::Duration after) {
    return Progress{{is_short(after) ? 1.0 : 0.9, 0.0}, is_short(after) ? 8.0 : 10.7};
  });
  ASSERT_TRUE(given_up);
  EXPECT_TRUE(is_short(*given_up));
  // The first longer path and the first return to the short one begin the count.
  EXPECT_LE(*given_up, 3s + PathProgress::kPatience + 1s);
}

// The short path shows itself once more before the robot drives along the longer one, of which more
// is left for a minute than there was of the short one.
TEST(PathProgress, WhoeverDrivesAlongTheLongerPathMakesProgress) {
  EXPECT_FALSE(given_up_after(60s, [](time::Duration after) {
    const double driven_m = after < 3s ? 0.0 : 0.1 * time::seconds(after - 3s);
    const bool is_short = after < 1s || (after >= 2s && after < 3s);
    return Progress{{driven_m, 0.0}, is_short ? 8.0 : 15.0 - driven_m};
  }));
}

}  // namespace path_progress_test
}  // namespace nodmap::navigator
