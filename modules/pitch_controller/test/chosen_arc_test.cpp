// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/chosen_arc.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/robot/stopping.hpp"

namespace nodmap::pitch_controller {
namespace chosen_arc_test {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kProcessingS = 0.05;
const robot::Braking kBraking;

NeededView view(OnArc does, double free_m, double max_forward_mps, double bound_mps = 1.0) {
  return needed_view({{}, does, free_m, max_forward_mps}, 0.8, bound_mps, kBraking, kProcessingS);
}

TEST(ChosenArc, WhereTheBoundAloneKeepsTheRobotSlowItUsesTheFreePart) {
  EXPECT_EQ(view(OnArc::kDrives, 0.7, 1.0).used_m, 0.7);
  EXPECT_EQ(view(OnArc::kDrives, kInfinity, 1.0).used_m, kInfinity);
  EXPECT_EQ(view(OnArc::kDrives, 0.7, 1.0).floor_from_m, kInfinity);
}

// In a bend, or while it rotates, the robot gains nothing from shorter sweeps.
TEST(ChosenArc, OtherwiseItLooksAsFarAsBySpeed) {
  EXPECT_EQ(view(OnArc::kDrives, 0.7, 0.5).used_m, kInfinity);
  EXPECT_EQ(view(OnArc::kElse, 0.7, 1.0).used_m, kInfinity);
  EXPECT_EQ(view(OnArc::kElse, kInfinity, 1.0).floor_from_m, kInfinity);
}

TEST(ChosenArc, GroundThatWasNotSeenIsLookedForWhereTheRobotCouldJustStop) {
  const NeededView down = view(OnArc::kSlowed, 3.0, 0.5);
  EXPECT_EQ(down.floor_from_m,
            robot::stopping_distance(0.8, kProcessingS, kBraking.emergency_deceleration_mps2));
  EXPECT_EQ(down.used_m, kInfinity);
  // This one brakes for the obstacle 0.3 m ahead.
  EXPECT_EQ(view(OnArc::kSlowed, 0.3, 0.5).floor_from_m, kInfinity);
}

}  // namespace chosen_arc_test
}  // namespace nodmap::pitch_controller
