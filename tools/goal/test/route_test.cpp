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
  Route route(kThree, false, time::from_seconds(10));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(route.waypoint_map(), kThree.at(static_cast<std::size_t>(i)));
    EXPECT_EQ(route.take_arrival(false), Event::kNone);
    EXPECT_FALSE(route.is_over());
    EXPECT_EQ(route.take_arrival(true), Event::kReached);
  }
  EXPECT_TRUE(route.is_over());
  EXPECT_EQ(route.num_missed(), 0);
  EXPECT_EQ(route.index(), 2U);
  EXPECT_EQ(route.take_arrival(true), Event::kNone) << "once only";
  EXPECT_EQ(route.take_path(false, at(1)), Event::kNone);
  EXPECT_EQ(route.take_path(false, at(20)), Event::kNone);
  EXPECT_EQ(route.num_missed(), 0);
}

TEST(Route, AWaypointIsMissedAfterALongTimeWithoutAPath) {
  Route route(kThree, false, time::from_seconds(10));
  EXPECT_EQ(route.take_path(false, at(3)), Event::kNone);
  EXPECT_EQ(route.take_path(false, at(12.9)), Event::kNone);
  EXPECT_EQ(route.take_path(true, at(12.95)), Event::kNone) << "a door has opened";
  EXPECT_EQ(route.take_path(false, at(14)), Event::kNone);
  EXPECT_EQ(route.take_path(false, at(23.9)), Event::kNone);
  EXPECT_EQ(route.take_path(false, at(24)), Event::kMissed);
  EXPECT_EQ(route.index(), 1U);
  EXPECT_EQ(route.num_missed(), 1);
  EXPECT_EQ(route.take_path(false, at(24.1)), Event::kNone) << "the patience begins anew";
}

TEST(Route, TimeInWhichTheRobotIsHaltedIsNoTimeWithoutAPath) {
  Route route(kThree, false, time::from_seconds(10));
  EXPECT_EQ(route.take_path(false, at(3)), Event::kNone);
  route.take_halt(at(8));
  route.take_halt(at(60));
  EXPECT_EQ(route.take_path(false, at(69.9)), Event::kNone);
  EXPECT_EQ(route.take_path(false, at(70)), Event::kMissed);
}

TEST(Route, APatrolGoesRoundUntilEveryWaypointIsMissedInTurn) {
  Route route(kThree, true, time::from_seconds(1));
  double now_s = 0.0;
  for (int i = 0; i < 7; ++i) {
    EXPECT_EQ(route.take_arrival(true), Event::kReached);
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
