// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/proximity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "modules/navigator/local_map/test/scanned_ground.hpp"
#include "modules/navigator/people/test/walking_scene.hpp"

namespace nodmap::navigator {
namespace proximity_test {

using test::at;
using test::kScanS;
using test::WalkingScene;

// The ranges of the infrared range finders when only one of them measures something.
Proximity::Ranges only(robot::Infrared sensor, double range_m) {
  Proximity::Ranges ranges_m;
  ranges_m.fill(std::numeric_limits<double>::quiet_NaN());
  ranges_m[static_cast<std::size_t>(sensor)] = range_m;
  return ranges_m;
}

class ProximityTest : public ::testing::Test {
 protected:
  static constexpr robot::Infrared kBack = robot::Infrared::kBack;
  static constexpr robot::Infrared kRight = robot::Infrared::kRight;

  // From the origin the robot sees the floor ahead and a post; then it stands on that floor.
  ProximityTest() {
    const WalkingScene scene{{{{1.5, -0.6}, 0.1, 1.7}}, 6.0};
    for (double time_s = 0.0; time_s < 3.0; time_s += kScanS) {
      map_.add_scan(scene.scan(at(time_s), {}, test::nodding_pitch_rad(time_s)), {});
    }
  }

  [[nodiscard]] bool sees(double time_s, const Proximity::Ranges& ranges_m,
                          const People& tracked_odom = {}) {
    proximity_.add(at(time_s), ranges_m, {1.5, 0.0, 0.0}, map_, tracked_odom);
    return proximity_.is_detected(at(time_s));
  }

  LocalMap map_{{}, {}};
  Proximity proximity_;
};

TEST_F(ProximityTest, SomebodyBehindIsDetectedUntilHalfASecondAfterTheLastReading) {
  EXPECT_FALSE(sees(10.0, only(kBack, std::numeric_limits<double>::quiet_NaN())));
  EXPECT_TRUE(sees(11.0, only(kBack, 0.4)));
  EXPECT_TRUE(sees(11.4, only(kRight, std::numeric_limits<double>::quiet_NaN())));
  EXPECT_FALSE(proximity_.is_detected(at(11.6)));
  EXPECT_FALSE(proximity_.is_detected(at(9.0))) << "a clock that was set back";
}

TEST_F(ProximityTest, AReadingOfAnObstacleInTheMapIsNotAPerson) {
  EXPECT_FALSE(sees(10.0, only(kRight, 0.335))) << "the post";
  EXPECT_FALSE(sees(10.1, only(kRight, 0.25))) << "the post, with an error of the sensor";
  EXPECT_TRUE(sees(10.2, only(kRight, 0.1))) << "something before the post";
}

// The reading is 0.4 m behind the body, whose rear is at 1.5 - 0.225 m.
TEST_F(ProximityTest, AReadingOfATrackedPersonIsNotAnotherPerson) {
  const Person him{{0.7, 0.0}, {0.5, 0.0}, 0.25, 0.1, 0.1};
  Person elsewhere = him;
  elsewhere.position.x() = 0.0;
  EXPECT_FALSE(sees(10.0, only(kBack, 0.4), {him}));
  EXPECT_TRUE(sees(10.1, only(kBack, 0.4), {elsewhere}));
}

TEST_F(ProximityTest, AReadingWhereNoFloorWasSeenIsNotAPerson) {
  proximity_.add(at(10.0), only(kBack, 0.4), {-2.0, 0.0, 0.0}, map_, {});
  EXPECT_FALSE(proximity_.is_detected(at(10.0)));
}

TEST_F(ProximityTest, AConstantReadingIsIgnoredAfterAWhileAndANearerOneIsNot) {
  double time_s = 10.0;
  for (; time_s < 10.55; time_s += 0.05) {
    EXPECT_TRUE(sees(time_s, only(kBack, 0.4)));
  }
  for (; time_s < 11.2; time_s += 0.05) {
    static_cast<void>(sees(time_s, only(kBack, 0.4)));
  }
  EXPECT_FALSE(sees(time_s, only(kBack, 0.4)));
  EXPECT_TRUE(sees(time_s + 0.05, only(kBack, 0.3))) << "it comes nearer";
}

// The robot's side is at -0.165 m.
TEST_F(ProximityTest, WhoeverStandsIsAnObstacleUntilTheSensorLooksThroughTheirPlace) {
  const geometry::SE2 here{1.5, 0.0, 0.0};
  const auto stand_for = [&](double from_s, double to_s) {
    for (double time_s = from_s; time_s < to_s; time_s += 0.05) {
      static_cast<void>(sees(time_s, only(kRight, 0.06)));
    }
  };
  stand_for(10.0, 10.55);
  EXPECT_TRUE(proximity_.points_base(here).empty()) << "they may still be walking";
  stand_for(10.55, 12.0);
  const Points points = proximity_.points_base(here);
  ASSERT_FALSE(points.empty());
  for (const Eigen::Vector2d& p : points) {
    EXPECT_NEAR(p.y(), -0.225, 1e-9);
    EXPECT_LE(std::abs(p.x()), 0.15 + 1e-9);
  }
  // From elsewhere in odom they are at the same place, although no sensor looks there.
  const geometry::SE2 turned{1.5, 0.0, 0.4};
  proximity_.add(at(12.1), only(kRight, std::numeric_limits<double>::quiet_NaN()), turned, map_,
                 {});
  const Points again = proximity_.points_base(turned);
  ASSERT_EQ(again.size(), points.size());
  EXPECT_LT((turned * again.front() - here * points.front()).norm(), 1e-9);
  static_cast<void>(sees(12.2, only(kRight, 0.08)));
  EXPECT_FALSE(proximity_.points_base(here).empty()) << "noise";
  static_cast<void>(sees(12.3, only(kRight, std::numeric_limits<double>::quiet_NaN())));
  EXPECT_FALSE(proximity_.points_base(here).empty()) << "it has not looked";
  static_cast<void>(sees(12.4, only(kRight, std::numeric_limits<double>::infinity())));
  EXPECT_TRUE(proximity_.points_base(here).empty());
}

TEST_F(ProximityTest, WhoeverStandsIsForgottenFromAMetreAwayOn) {
  for (double time_s = 10.0; time_s < 12.0; time_s += 0.05) {
    static_cast<void>(sees(time_s, only(kBack, 0.3)));
  }
  const auto drive_to = [&](double x_m) {
    const geometry::SE2 there{x_m, 0.0, 0.0};
    proximity_.add(at(13.0), only(kRight, std::numeric_limits<double>::quiet_NaN()), there, map_,
                   {});
    return proximity_.points_base(there);
  };
  EXPECT_FALSE(drive_to(1.9).empty());
  EXPECT_TRUE(drive_to(2.9).empty());
}

TEST_F(ProximityTest, AReadingOfAForgottenObstacleIsNotAPerson) {
  // Odometry drifts while the robot rotates, looking elsewhere: 8 rad count as 32 m of travel.
  for (int i = 0; i < 80; ++i) {
    const double yaw_rad = geometry::kPi + (i % 2 == 0 ? 0.05 : -0.05);
    map_.add_scan(WalkingScene{{}, 6.0}.scan(at(3.0 + i * kScanS), {0.0, 0.0, yaw_rad}, 0.0),
                  {0.0, 0.0, yaw_rad});
  }
  ASSERT_FALSE(test::is_blocked_at(map_, Eigen::Vector2d(1.5, -0.5))) << "the post";
  EXPECT_FALSE(sees(10.0, only(kRight, 0.335)));
}

// Only the ground under the body is known here, and its border is no exception.
TEST_F(ProximityTest, AReadingOnFloorThatIsOnlyAssumedIsNotAPerson) {
  const WalkingScene scene{{}, 6.0};
  LocalMap map{{}, {}};
  map.add_scan(scene.scan(at(0.0), {}, 0.0), {});
  ASSERT_TRUE(map.is_only_floor({-0.35, 0.0}));
  for (std::size_t sensor = 0; sensor < robot::kInfraredCount; ++sensor) {
    for (double range_m = 0.1; range_m <= 0.8; range_m += 0.005) {
      Proximity proximity;
      proximity.add(at(10.0), only(static_cast<robot::Infrared>(sensor), range_m), {}, map, {});
      EXPECT_FALSE(proximity.is_detected(at(10.0))) << sensor << ' ' << range_m;
    }
  }
}

}  // namespace proximity_test
}  // namespace nodmap::navigator
