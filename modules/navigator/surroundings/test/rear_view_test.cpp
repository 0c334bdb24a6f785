// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/surroundings/rear_view.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "common/robot/infrared.hpp"

namespace nodmap::navigator {
namespace rear_view_test {

constexpr double kNothing = std::numeric_limits<double>::infinity();
constexpr double kSilent = std::numeric_limits<double>::quiet_NaN();

time::Timestamp at(double time_s) {
  return time::Timestamp(time::from_seconds(100.0 + time_s));
}

// All range finders measure nothing, except one.
Proximity::Ranges all_but(robot::Infrared sensor, double range_m) {
  Proximity::Ranges ranges_m;
  ranges_m.fill(kNothing);
  ranges_m[static_cast<std::size_t>(sensor)] = range_m;
  return ranges_m;
}

struct RearViewTest : testing::Test {
  RearView rear{NavigatorParams{}};
};

TEST_F(RearViewTest, ABaseWhoseRangeFindersHaveNeverMeasuredAnythingMayHaveNone) {
  rear.add(at(0.0), all_but(robot::Infrared::kLeft, kNothing), {});
  EXPECT_FALSE(rear.is_looking(at(0.0)));
  rear.add(at(0.1), all_but(robot::Infrared::kLeft, 0.06), {});
  EXPECT_TRUE(rear.is_looking(at(0.1)));
}

TEST_F(RearViewTest, AllThreeThatLookBackwardsMustAnswerAllTheTime) {
  for (const auto sensor :
       {robot::Infrared::kLeftBack, robot::Infrared::kBack, robot::Infrared::kRightBack}) {
    rear.add(at(0.0), all_but(robot::Infrared::kRight, 0.06), {});
    EXPECT_TRUE(rear.is_looking(at(0.1)));
    EXPECT_FALSE(rear.is_looking(at(0.3))) << "no message for 0.3 s";
    rear.add(at(0.1), all_but(sensor, kSilent), {});
    EXPECT_FALSE(rear.is_looking(at(0.1)));
  }
}

TEST_F(RearViewTest, AReadingIsAPointInOdomForTenSeconds) {
  rear.add(at(0.0), all_but(robot::Infrared::kBack, 0.3), {1.0, 0.0, 0.0});
  // The range finder is 0.217 m behind base. The robot has backed up by 0.1 m since.
  const Points points = rear.points_base({0.9, 0.0, 0.0});
  ASSERT_EQ(points.size(), 1U);
  EXPECT_NEAR(points[0].x(), -0.417, 1e-9);
  EXPECT_NEAR(points[0].y(), 0.0, 1e-9);
  rear.add(at(10.1), all_but(robot::Infrared::kBack, kNothing), {0.9, 0.0, 0.0});
  EXPECT_TRUE(rear.points_base({0.9, 0.0, 0.0}).empty());
}

TEST_F(RearViewTest, ReadingsThatAreNoRangesAreNoPoints) {
  for (const double range_m : {-1.0, 1e9, kSilent, kNothing}) {
    rear.add(at(0.0), all_but(robot::Infrared::kBack, range_m), {});
    EXPECT_TRUE(rear.points_base({}).empty()) << range_m;
  }
}

TEST_F(RearViewTest, ARobotThatHasLeftTheStartMayNotBackUpThereAgain) {
  const auto ranges_m = all_but(robot::Infrared::kBack, 0.3);
  rear.add(at(0.0), ranges_m, {});
  EXPECT_DOUBLE_EQ(rear.permitted_m({-0.5, 0.0, 0.0}), 0.7);
  rear.add(at(1.0), ranges_m, {1.3, 0.0, 0.0});
  rear.add(at(2.0), ranges_m, {});
  EXPECT_EQ(rear.permitted_m({}), 0.0);
  EXPECT_FALSE(rear.is_looking(at(2.0)));
  EXPECT_TRUE(rear.points_base({}).empty());
}

}  // namespace rear_view_test
}  // namespace nodmap::navigator
