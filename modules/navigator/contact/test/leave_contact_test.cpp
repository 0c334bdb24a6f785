// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/contact/leave_contact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

namespace nodmap::navigator {
namespace leave_contact_test {

Situation at(double x_m, double forward_mps = 0.0, time::Duration after = {}) {
  Situation now;
  now.stamp = time::Timestamp(10s + after);
  now.T_odom_base = {x_m, 0.0, 0.0};
  now.forward_mps = forward_mps;
  return now;
}

// Of a robot that has driven an arc, and ends at the origin.
Trail trail_of(double length_m, double curvature) {
  Trail trail(20.0);
  for (double before_m = length_m; before_m > -1e-9; before_m -= 0.01) {
    const geometry::SE2 T_odom_base =
        curvature == 0.0 ? geometry::SE2{-before_m, 0.0, 0.0}
                         : geometry::SE2{-std::sin(curvature * before_m) / curvature,
                                         (1.0 - std::cos(curvature * before_m)) / curvature,
                                         -curvature * before_m};
    trail.move(T_odom_base);
    trail.record(T_odom_base);
  }
  return trail;
}

// It has slipped by 0.4 m and is now stationary at 0.4 m.
LeaveContact touching(const Trail& trail) {
  LeaveContact leave{NavigatorParams{}};
  leave.begin(at(0.0).stamp, {}, {0.4, 0.0, 0.0}, trail);
  EXPECT_TRUE(leave.take_contact(at(0.4)));
  return leave;
}

TEST(LeaveContact, TheContactIsWhereTheWheelsCameToRest) {
  LeaveContact leave{NavigatorParams{}};
  EXPECT_FALSE(leave.take_contact(at(0.0))) << "it touches nothing";
  leave.begin(at(0.0).stamp, {}, {0.3, 0.0, 0.0}, trail_of(1.0, 0.0));
  EXPECT_FALSE(leave.take_contact(at(0.3, 1.5)));
  EXPECT_TRUE(leave.is_stopping());
  const auto contact = leave.take_contact(at(0.4));
  ASSERT_TRUE(contact);
  EXPECT_EQ(contact->T_base.x, 0.4);
  EXPECT_TRUE(contact->at_front);
  EXPECT_FALSE(leave.is_stopping());
}

TEST(LeaveContact, WheelsThatDoNotComeToRestDoNotStopItForEver) {
  LeaveContact leave{NavigatorParams{}};
  leave.begin(at(0.0).stamp, {}, {0.3, 0.0, 0.0}, trail_of(1.0, 0.0));
  EXPECT_FALSE(leave.take_contact(at(0.4, 0.05, 4s)));
  EXPECT_TRUE(leave.take_contact(at(0.6, 0.05, 6s)));
  EXPECT_FALSE(leave.is_active());
  EXPECT_FALSE(leave.step(at(0.6, 0.05, 6s))) << "it is not known how far it may back up";
}

TEST(LeaveContact, BacksUpForThirtyCentimetresOnTheArcOnWhichItCame) {
  for (const double curvature : {0.0, 0.5, -1.5}) {
    LeaveContact leave = touching(trail_of(1.0, curvature));
    const auto decision = leave.step(at(0.11));
    ASSERT_TRUE(decision) << curvature;
    EXPECT_EQ(decision->forward_mps, -BackUpParams{}.speed_mps);
    // The trail is a polygon of 3 cm edges.
    EXPECT_NEAR(decision->yaw_rate_rad_s, decision->forward_mps * curvature, 0.02) << curvature;
    EXPECT_FALSE(leave.step(at(0.09)));
    EXPECT_FALSE(leave.step(at(0.15))) << "it has ended";
  }
}

// Nobody knows what is behind the place where it was set down.
TEST(LeaveContact, BacksUpNoFartherThanItHasDriven) {
  LeaveContact leave = touching(trail_of(0.1, 0.0));
  EXPECT_TRUE(leave.step(at(0.38)));
  EXPECT_FALSE(leave.step(at(0.25)));
  EXPECT_FALSE(touching(trail_of(0.0, 0.0)).step(at(0.25)));
}

TEST(LeaveContact, AfterDrivingBackwardsIntoSomethingItOnlyStops) {
  LeaveContact leave{NavigatorParams{}};
  leave.begin(at(0.0).stamp, {}, {-0.2, 0.0, 0.0}, trail_of(1.0, 0.0));
  const auto contact = leave.take_contact(at(-0.2));
  ASSERT_TRUE(contact);
  EXPECT_FALSE(contact->at_front);
  EXPECT_FALSE(leave.step(at(-0.2)));
}

// By a STOP, during which nothing is decided and somebody may move it.
TEST(LeaveContact, ARobotThatIsHaltedForLongBeforeItHasStoppedDoesNotBackUpAfterwards) {
  for (const auto& [halted, leaves] : {std::pair(2s, true), std::pair(60s, false)}) {
    LeaveContact leave{NavigatorParams{}};
    leave.begin(at(0.0).stamp, {}, {0.3, 0.0, 0.0}, trail_of(1.0, 0.0));
    const Situation now = at(0.4, 0.0, halted);
    EXPECT_TRUE(leave.take_contact(now)) << "it is still there";
    EXPECT_EQ(leave.step(now).has_value(), leaves);
  }
}

TEST(LeaveContact, EndsBeforeWhatIsMeasuredBehindAndAfterTenSeconds) {
  Proximity::Ranges ranges_m;
  ranges_m.fill(std::numeric_limits<double>::quiet_NaN());
  LeaveContact leave = touching(trail_of(1.0, 0.0));
  leave.add_ranges(at(0.0).stamp, ranges_m);
  EXPECT_TRUE(leave.step(at(0.4))) << "without range finders";
  ranges_m[static_cast<std::size_t>(robot::Infrared::kBack)] = 0.05;
  leave.add_ranges(at(0.0).stamp, ranges_m);
  EXPECT_FALSE(leave.step(at(0.4)));

  LeaveContact slow = touching(trail_of(1.0, 0.0));
  EXPECT_TRUE(slow.step(at(0.3, 0.0, 9s)));
  EXPECT_FALSE(slow.step(at(0.3, 0.0, 11s)));
}

}  // namespace leave_contact_test
}  // namespace nodmap::navigator
