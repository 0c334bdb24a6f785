// SPDX-License-Identifier: BSD-3-Clause
#include "tools/goal/route.hpp"

#include <gtest/gtest.h>

namespace nodmap {
namespace route_test {

using Event = Route::Event;

time::SteadyTime at(double seconds) {
  return time::SteadyTime(time::from_seconds(seconds));
}

const std::vector<Eigen::Vector2d> kThree{{1, 0}, {2, 0}, {3, 0}};

TEST(Route, LeadsFromOneWaypointToTheNextAndIsOverAfterTheLast) {
  Route route(kThree, false, time::from_seconds(10), at(0));
  for (int i = 0; i < 3; ++i) {
    const double begin_s = 10.0 * i;
    EXPECT_EQ(route.waypoint_map(), kThree.at(static_cast<std::size_t>(i)));
    EXPECT_EQ(route.take_arrival(false, at(begin_s + 1.0)), Event::kNone);
    EXPECT_FALSE(route.is_over());
    EXPECT_EQ(route.take_arrival(true, at(begin_s + 10.0)), Event::kReached);
  }
  EXPECT_TRUE(route.is_over());
  EXPECT_EQ(route.num_missed(), 0);
  EXPECT_EQ(route.index(), 2U);
  EXPECT_EQ(route.take_arrival(true, at(40.0)), Event::kNone) << "once only";
}

// The navigator still reports that it is at the previous waypoint. Two of its goals were lost.
TEST(Route, AnArrivalCountsForTheWaypointItBelongsTo) {
  Route route(kThree, false, time::from_seconds(10), at(0));
  const time::SteadyTime third_goal = at(0) + 2 * Route::kRepeat;
  EXPECT_EQ(route.take_arrival(true, third_goal + 400ms), Event::kNone);
  EXPECT_EQ(route.take_arrival(true, third_goal + 600ms), Event::kReached)
      << "where it stands already";
  EXPECT_EQ(route.take_arrival(true, third_goal + 900ms), Event::kNone);
  EXPECT_EQ(route.index(), 1U);
}

TEST(Route, AWaypointIsMissedAfterALongTimeWithoutAPath) {
  Route route(kThree, false, time::from_seconds(10), at(0));
  EXPECT_EQ(route.take_path(false, at(3)), Event::kNone);
  EXPECT_EQ(route.take_path(false, at(12.9)), Event::kNone);
  EXPECT_EQ(route.take_path(true, at(12.95)), Event::kNone) << "a door has opened";
  EXPECT_EQ(route.take_path(false, at(14)), Event::kNone);
  EXPECT_EQ(route.take_path(false, at(23.9)), Event::kNone);
  EXPECT_EQ(route.take_path(false, at(24)), Event::kMissed);
  EXPECT_EQ(route.index(), 1U);
  EXPECT_EQ(route.num_missed(), 1);
  EXPECT_EQ(route.take_path(false, at(24.1)), Event::kNone) << "of the waypoint before";
}

TEST(Route, APatrolGoesRoundUntilEveryWaypointIsMissedInTurn) {
  Route route(kThree, true, time::from_seconds(1), at(0));
  double now_s = 0.0;
  for (int i = 0; i < 7; ++i) {
    EXPECT_EQ(route.take_arrival(true, at(now_s += 5.0)), Event::kReached);
  }
  EXPECT_EQ(route.index(), 1U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(route.is_over());
    EXPECT_EQ(route.take_path(false, at(now_s += 3.0)), Event::kNone);
    EXPECT_EQ(route.take_path(false, at(now_s += 1.0)), Event::kMissed);
  }
  EXPECT_TRUE(route.is_over());
  EXPECT_EQ(route.num_missed(), 3);
}

}  // namespace route_test
}  // namespace nodmap
