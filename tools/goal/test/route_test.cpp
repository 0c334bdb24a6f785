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

// Ten times a second the navigator reports that there is no path; returns the last event.
Event report_no_path(Route& route, double from_s, double until_s) {
  Event event = Event::kNone;
  for (double now_s = from_s; now_s < until_s + 0.05 && event == Event::kNone; now_s += 0.1) {
    event = route.take_path(false, at(now_s));
  }
  return event;
}

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
  EXPECT_EQ(report_no_path(route, 1.0, 20.0), Event::kNone);
  EXPECT_EQ(route.num_missed(), 0);
}

TEST(Route, AWaypointIsMissedAfterALongTimeWithoutAPath) {
  Route route(kThree, false, time::from_seconds(10));
  EXPECT_EQ(report_no_path(route, 3.0, 12.8), Event::kNone);
  EXPECT_EQ(route.take_path(true, at(12.9)), Event::kNone) << "a door has opened";
  EXPECT_EQ(report_no_path(route, 14.0, 23.8), Event::kNone);
  EXPECT_EQ(report_no_path(route, 23.9, 24.1), Event::kMissed);
  EXPECT_EQ(route.index(), 1U);
  EXPECT_EQ(route.num_missed(), 1);
  EXPECT_EQ(report_no_path(route, 24.2, 34.0), Event::kNone) << "the patience begins anew";
}

// While the robot is halted, the navigator says nothing of a path.
TEST(Route, SilenceIsNoTimeWithoutAPath) {
  Route route(kThree, false, time::from_seconds(10));
  EXPECT_EQ(report_no_path(route, 3.0, 8.0), Event::kNone);
  EXPECT_EQ(report_no_path(route, 60.0, 64.8), Event::kNone);
  EXPECT_EQ(report_no_path(route, 64.9, 65.1), Event::kMissed);
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
    EXPECT_EQ(report_no_path(route, now_s, now_s + 1.1), Event::kMissed);
    now_s += 3.0;
  }
  EXPECT_TRUE(route.is_over());
  EXPECT_EQ(route.num_missed(), 3);
}

}  // namespace route_test
}  // namespace nodmap
