// SPDX-License-Identifier: BSD-3-Clause
#include "common/geometry/pose_history.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace nodmap::geometry {
namespace pose_history_test {

SE3 at_x(double x) {
  return to_se3(SE2{x, 0, 0});
}

time::Timestamp at(time::Duration since_epoch) {
  return time::Timestamp(since_epoch);
}

TEST(PoseHistory, WithoutSamplesThereIsNoPose) {
  EXPECT_FALSE(PoseHistory().at(at(0s)).has_value());
}

TEST(PoseHistory, InterpolatesAndHitsSamplesExactly) {
  PoseHistory history;
  history.add(at(1s), at_x(1));
  history.add(at(2s), at_x(3));
  EXPECT_EQ(history.at(at(1s))->translation().x(), 1.0);
  EXPECT_EQ(history.at(at(2s))->translation().x(), 3.0);
  EXPECT_DOUBLE_EQ(history.at(at(1250ms))->translation().x(), 1.5);
}

// Odometry was lost, and the robot drove on.
TEST(PoseHistory, BetweenSamplesFarApartTheMotionOfTheRobotIsNotKnown) {
  PoseHistory history;
  history.add(at(1s), at_x(1));
  history.add(at(2s), at_x(3));
  history.add(at(32s), at_x(4));
  history.add(at(33s), at_x(5));
  EXPECT_DOUBLE_EQ(history.at(at(1500ms))->translation().x(), 2.0);
  EXPECT_EQ(history.at(at(2s))->translation().x(), 3.0);
  EXPECT_FALSE(history.at(at(2'000'001us)).has_value());
  EXPECT_FALSE(history.at(at(31'999'999us)).has_value());
  EXPECT_EQ(history.at(at(32s))->translation().x(), 4.0);
  EXPECT_DOUBLE_EQ(history.at(at(32500ms))->translation().x(), 4.5);
}

// A recording that tells the pose once for each place at which the robot stopped.
TEST(PoseHistory, ARobotThatHasNotMovedWasStationary) {
  PoseHistory history;
  history.add(at(1s), at_x(0));
  history.add(at(21s), at_x(0.008));
  history.add(at(41s), at_x(0.020));
  history.add(at(61s), to_se3(SE2{0.020, 0.0, 0.003}));
  EXPECT_DOUBLE_EQ(history.at(at(11s))->translation().x(), 0.004);
  EXPECT_FALSE(history.at(at(31s)).has_value());
  EXPECT_FALSE(history.at(at(51s)).has_value());
}

TEST(PoseHistory, InterpolatesATrajectoryAsFarAsItIsTold) {
  PoseHistory history(60s, 50ms, 10s);
  history.add(at(0s), at_x(0));
  history.add(at(10s), at_x(5));
  history.add(at(21s), at_x(6));
  EXPECT_DOUBLE_EQ(history.at(at(5s))->translation().x(), 2.5);
  EXPECT_FALSE(history.at(at(15s)).has_value());
}

TEST(PoseHistory, ExtrapolatesOnlySoFar) {
  PoseHistory history(10s, 50ms);
  history.add(at(0s), at_x(0));
  history.add(at(10ms), at_x(0.01));  // 1 m/s
  EXPECT_NEAR(history.at(at(30ms))->translation().x(), 0.03, 1e-12);
  EXPECT_TRUE(history.at(at(60ms)).has_value());
  EXPECT_FALSE(history.at(at(60'001us)).has_value());
  EXPECT_TRUE(history.at(at(-50ms)).has_value());
  EXPECT_FALSE(history.at(at(-50'001us)).has_value());
}

TEST(PoseHistory, ExtrapolationHoldsThePoseWhereTheVelocityIsUnknown) {
  PoseHistory history(60s, 50ms);
  history.add(at(0s), at_x(0));
  history.add(at(5s), at_x(5));
  EXPECT_EQ(history.at(at(5040ms))->translation().x(), 5.0);
}

TEST(PoseHistory, SteppingBackReplacesWhatItContradicts) {
  PoseHistory history;
  history.add(at(1s), at_x(1));
  history.add(at(3s), at_x(3));
  history.add(at(2s), at_x(7));  // the clock stepped back by a second
  EXPECT_EQ(history.at(at(2s))->translation().x(), 7.0);
  EXPECT_DOUBLE_EQ(history.at(at(1500ms))->translation().x(), 4.0);
  EXPECT_FALSE(history.at(at(3s)).has_value());
}

TEST(PoseHistory, APoseIsAwaitedUntilSamplesReachItButNotForever) {
  PoseHistory history(10s, 50ms);
  EXPECT_FALSE(history.is_awaited(at(1s), at(1s)));  // nothing comes
  history.add(at(1s), at_x(1));
  EXPECT_FALSE(history.is_awaited(at(1050ms), at(1050ms)));
  EXPECT_TRUE(history.is_awaited(at(1051ms), at(1051ms)));
  EXPECT_TRUE(history.is_awaited(at(1051ms), at(1551ms)));
  EXPECT_FALSE(history.is_awaited(at(1051ms), at(1552ms)));
  EXPECT_FALSE(history.is_awaited(at(9s), at(8s)));         // the clock stepped back
  EXPECT_FALSE(history.is_awaited(at(1051ms), at(700ms)));  // by little
  EXPECT_FALSE(history.is_awaited(at(-9s), at(-9s)));       // too old: no sample will tell it
  history.add(at(1200ms), at_x(1));
  EXPECT_FALSE(history.is_awaited(at(1051ms), at(1200ms)));
}

TEST(PoseHistory, ForgetsBeyondItsSpanAndRefusesNonsense) {
  PoseHistory history(1s, 0s);
  for (int i = 0; i <= 100; ++i) {
    history.add(at(100ms * i), at_x(i));
  }
  EXPECT_FALSE(history.at(at(8s)).has_value());
  EXPECT_TRUE(history.at(at(9s)).has_value());
  SE3 broken = SE3::Identity();
  broken.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(history.add(at(20s), broken));
}

TEST(PoseHistory, KnowsItsNewestAndForgets) {
  PoseHistory history;
  EXPECT_FALSE(history.newest().has_value());
  history.add(at(1s), at_x(1));
  history.add(at(2s), at_x(3));
  EXPECT_EQ(history.newest()->translation().x(), 3.0);
  history.clear();
  EXPECT_FALSE(history.newest().has_value());
  EXPECT_FALSE(history.at(at(2s)).has_value());
}

}  // namespace pose_history_test
}  // namespace nodmap::geometry
