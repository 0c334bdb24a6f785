// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/unseen_places.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::pitch_controller {
namespace unseen_places_test {

// Two radians up and down again at 2 rad/s, and 0.1 s for the reversals in between.
const NodMotion kNod{{-1.0, 1.0}, 2.0, 0.1};
constexpr double kRevisitS = 1.1;

TEST(UnseenPlaces, AnObstacleComesNearerUntilTheLaserHasPassedAgain) {
  UnseenPlaces dut;
  EXPECT_TRUE(std::isinf(dut.nearest_hit_m(kNod, kRevisitS, 1.0)));
  dut.add(2.0);
  EXPECT_DOUBLE_EQ(dut.nearest_hit_m(kNod, kRevisitS, 1.0), 2.0 - 1.1);
  // 0.3 s at 1 m/s, in which the head turns by 0.6 rad: the rest of the angle takes 0.8 s.
  dut.advance(0.3, 0.6);
  EXPECT_DOUBLE_EQ(dut.nearest_hit_m(kNod, kRevisitS, 1.0), 2.0 - 1.1);
  EXPECT_DOUBLE_EQ(dut.nearest_hit_m(kNod, kRevisitS, 0.5), 1.7 - 0.4);
}

TEST(UnseenPlaces, TheNearestOneCounts) {
  UnseenPlaces dut;
  dut.add(2.0);
  dut.advance(0.5, 1.0);  // 1.5 m ahead, and measured 0.6 s from now
  dut.add(1.6);
  EXPECT_DOUBLE_EQ(dut.least_protected_m(), 1.6);
  EXPECT_DOUBLE_EQ(dut.nearest_hit_m(kNod, kRevisitS, 1.0), 1.6 - 1.1);
  EXPECT_DOUBLE_EQ(dut.nearest_hit_m(kNod, kRevisitS, 0.1), 1.5 - 0.06);
}

TEST(UnseenPlaces, ItIsForgottenOnceItWasMeasured) {
  UnseenPlaces dut;
  dut.add(2.0);
  dut.advance(0.0, 2.1);
  dut.forget_measured(kNod, kRevisitS);
  EXPECT_EQ(dut.least_protected_m(), 2.0);
  dut.advance(0.0, 0.2);
  dut.forget_measured(kNod, kRevisitS);
  EXPECT_TRUE(std::isinf(dut.least_protected_m()));
}

// It is not farther away because the laser was early.
TEST(UnseenPlaces, OneThatWasMeasuredIsWhereItIs) {
  UnseenPlaces dut;
  dut.add(2.0);
  dut.advance(0.5, 4.0);
  EXPECT_DOUBLE_EQ(dut.nearest_hit_m(kNod, kRevisitS, 1.0), 1.5);
}

// A head that is stationary measures nothing, however long it takes.
TEST(UnseenPlaces, WithoutANodNothingIsForgotten) {
  UnseenPlaces dut;
  dut.add(1.0);
  for (int i = 0; i < 5'000; ++i) {
    dut.advance(1e-4, 0.0);
    dut.add(3.0);
    dut.forget_measured(kNod, kRevisitS);
  }
  EXPECT_EQ(dut.least_protected_m(), 1.0);
  EXPECT_NEAR(dut.nearest_hit_m(kNod, kRevisitS, 0.1), 0.5 - 0.11, 1e-9);  // rounding
}

}  // namespace unseen_places_test
}  // namespace nodmap::pitch_controller
