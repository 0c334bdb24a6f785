// SPDX-License-Identifier: BSD-3-Clause
#include "common/geometry/pose_history.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace nodmap::geometry {
namespace {

SE3 at_x(double x) {
  return to_se3(SE2{x, 0, 0});
}

TEST(PoseHistory, EmptyAnswersNothing) {
  EXPECT_FALSE(PoseHistory().at(0).has_value());
}

TEST(PoseHistory, InterpolatesAndHitsSamplesExactly) {
  PoseHistory history;
  history.add(1'000'000, at_x(1));
  history.add(2'000'000, at_x(3));
  EXPECT_EQ(history.at(1'000'000)->translation().x(), 1.0);
  EXPECT_EQ(history.at(2'000'000)->translation().x(), 3.0);
  EXPECT_DOUBLE_EQ(history.at(1'250'000)->translation().x(), 1.5);
}

TEST(PoseHistory, ExtrapolatesOnlySoFar) {
  PoseHistory history(10'000'000, 50'000);
  history.add(0, at_x(0));
  history.add(10'000, at_x(0.01));  // 1 m/s
  EXPECT_NEAR(history.at(30'000)->translation().x(), 0.03, 1e-12);
  EXPECT_TRUE(history.at(60'000).has_value());
  EXPECT_FALSE(history.at(60'001).has_value());
  EXPECT_TRUE(history.at(-50'000).has_value());
  EXPECT_FALSE(history.at(-50'001).has_value());
}

TEST(PoseHistory, ExtrapolationHoldsThePoseWhereTheVelocityIsUnknown) {
  PoseHistory history(60'000'000, 50'000);
  history.add(0, at_x(0));
  history.add(5'000'000, at_x(5));
  EXPECT_EQ(history.at(5'040'000)->translation().x(), 5.0);
}

TEST(PoseHistory, SteppingBackReplacesWhatItContradicts) {
  PoseHistory history;
  history.add(1'000'000, at_x(1));
  history.add(3'000'000, at_x(3));
  history.add(2'000'000, at_x(7));  // the clock stepped back by a second
  EXPECT_EQ(history.at(2'000'000)->translation().x(), 7.0);
  EXPECT_DOUBLE_EQ(history.at(1'500'000)->translation().x(), 4.0);
  EXPECT_FALSE(history.at(3'000'000).has_value());
}

TEST(PoseHistory, ForgetsBeyondItsSpanAndRefusesNonsense) {
  PoseHistory history(1'000'000, 0);
  for (int i = 0; i <= 100; ++i) {
    history.add(std::int64_t{100'000} * i, at_x(i));
  }
  EXPECT_FALSE(history.at(8'000'000).has_value());
  EXPECT_TRUE(history.at(9'000'000).has_value());
  SE3 broken = SE3::Identity();
  broken.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(history.add(20'000'000, broken));
}

TEST(PoseHistory, KnowsItsNewestAndForgets) {
  PoseHistory history;
  EXPECT_FALSE(history.newest().has_value());
  history.add(1'000'000, at_x(1));
  history.add(2'000'000, at_x(3));
  EXPECT_EQ(history.newest()->translation().x(), 3.0);
  history.clear();
  EXPECT_FALSE(history.newest().has_value());
  EXPECT_FALSE(history.at(2'000'000).has_value());
}

}  // namespace
}  // namespace nodmap::geometry
