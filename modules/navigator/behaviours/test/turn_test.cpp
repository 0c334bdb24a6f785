// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/behaviours/turn.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace nodmap::navigator {
namespace turn_test {

using geometry::deg_to_rad;

constexpr double kInf = std::numeric_limits<double>::infinity();

TurnInput free_to_turn(double heading_rad) {
  TurnInput input;
  input.heading_rad = heading_rad;
  input.left = input.right = {kInf, kInf};
  return input;
}

TEST(Turn, KeepsTheSideItChose) {
  Turn turn{NavigatorParams{}};
  TurnInput input = free_to_turn(0.0);
  input.clear_direction_rad = deg_to_rad(-40);
  EXPECT_LT(turn.step(input, Side::kNone).yaw_rate_rad_s, 0.0);
  input.clear_direction_rad = deg_to_rad(10);
  input.more_room_side = Side::kLeft;
  EXPECT_LT(turn.step(input, Side::kLeft).yaw_rate_rad_s, 0.0);
}

TEST(Turn, ChoosesTheSideByFreeDirectionThenByRoomAndElseLeft) {
  const auto first_side = [](double free_deg, Side room, Side preferred) {
    Turn turn{NavigatorParams{}};
    TurnInput input = free_to_turn(0.0);
    if (free_deg != 0.0) {
      input.clear_direction_rad = deg_to_rad(free_deg);
    }
    input.more_room_side = room;
    return turn.step(input, preferred).yaw_rate_rad_s > 0.0 ? Side::kLeft : Side::kRight;
  };
  EXPECT_EQ(first_side(-40, Side::kLeft, Side::kNone), Side::kRight);
  EXPECT_EQ(first_side(0, Side::kRight, Side::kNone), Side::kRight);
  EXPECT_EQ(first_side(0, Side::kNone, Side::kNone), Side::kLeft);
  EXPECT_EQ(first_side(-40, Side::kRight, Side::kLeft), Side::kLeft);
}

TEST(Turn, EndsOnlyWhenTheWayAheadIsSeenAndTheRobotIsStationary) {
  using Kind = TurnCommand::Kind;
  Turn turn{NavigatorParams{}};
  TurnInput input = free_to_turn(0.0);
  EXPECT_EQ(turn.step(input, Side::kNone).kind, Kind::kTurn);
  input.ahead_is_free = true;
  EXPECT_EQ(turn.step(input, Side::kNone).kind, Kind::kLook);
  input.ahead_is_seen = true;
  input.yaw_rate_rad_s = 0.5;
  EXPECT_EQ(turn.step(input, Side::kNone).kind, Kind::kLook);
  input.yaw_rate_rad_s = 0.0;
  EXPECT_EQ(turn.step(input, Side::kNone).kind, Kind::kFinished);
}

TEST(Turn, AfterAFullRotationItWaitsAndTriesAgain) {
  using Kind = TurnCommand::Kind;
  Turn turn{NavigatorParams{}};
  TurnInput input = free_to_turn(0.0);
  int steps = 0;
  while (turn.step(input, Side::kNone).kind == Kind::kTurn && steps < 1000) {
    input.heading_rad = geometry::normalize_angle(input.heading_rad + deg_to_rad(1));
    ++steps;
  }
  EXPECT_NEAR(steps, 360, 1);  // steps of a degree; rounding
  input.stamp = time::from_utime(4'900'000);
  EXPECT_EQ(turn.step(input, Side::kNone).kind, Kind::kWait);
  input.stamp = time::from_utime(5'100'000);
  EXPECT_EQ(turn.step(input, Side::kNone).kind, Kind::kTurn);
}

TEST(Turn, BlockedOnOneSideItTriesTheOtherOnceThenBacksUp) {
  using Kind = TurnCommand::Kind;
  Turn turn{NavigatorParams{}};
  TurnInput input = free_to_turn(0.0);
  EXPECT_GT(turn.step(input, Side::kLeft).yaw_rate_rad_s, 0.0);
  input.left.free_rotation_rad = 0.01;
  input.right.free_rotation_rad = 1.0;
  EXPECT_LT(turn.step(input, Side::kLeft).yaw_rate_rad_s, 0.0);
  input.left.free_rotation_rad = 1.0;
  input.right.free_rotation_rad = 0.01;
  EXPECT_EQ(turn.step(input, Side::kLeft).kind, Kind::kBackUp);
  input.right.free_rotation_rad = 1.0;  // no more than was tried before
  EXPECT_EQ(turn.step(input, Side::kLeft).kind, Kind::kBackUp);
  input.right.free_rotation_rad = kInf;
  EXPECT_EQ(turn.step(input, Side::kLeft).kind, Kind::kTurn);
}

TEST(Turn, BacksUpFirstWhereNeitherSideLeadsOut) {
  using Kind = TurnCommand::Kind;
  TurnInput input = free_to_turn(0.0);
  input.left.free_rotation_rad = deg_to_rad(31);
  input.right.free_rotation_rad = deg_to_rad(80);
  input.has_path_back = true;
  EXPECT_EQ(Turn(NavigatorParams{}).step(input, Side::kLeft).kind, Kind::kBackUp);
  // A side is good enough if the robot can rotate 150 degrees, or as far as a free direction.
  TurnInput reachable = input;
  reachable.right.to_clear_direction_rad = deg_to_rad(60);
  EXPECT_LT(Turn(NavigatorParams{}).step(reachable, Side::kLeft).yaw_rate_rad_s, 0.0);
  // Without a path back it turns as far as it can.
  input.has_path_back = false;
  EXPECT_GT(Turn(NavigatorParams{}).step(input, Side::kLeft).yaw_rate_rad_s, 0.0);
}

}  // namespace turn_test
}  // namespace nodmap::navigator
