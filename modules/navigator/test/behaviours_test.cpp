// SPDX-License-Identifier: BSD-3-Clause
// The parts: brake, seen directions, trail, turn, goal, staleness, obstacle points.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "modules/navigator/back_up.hpp"
#include "modules/navigator/brake.hpp"
#include "modules/navigator/goal.hpp"
#include "modules/navigator/obstacle_points.hpp"
#include "modules/navigator/seen_directions.hpp"
#include "modules/navigator/staleness.hpp"
#include "modules/navigator/turn.hpp"

namespace nodmap::navigator {
namespace behaviours_test {

using geometry::deg_to_rad;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kReactionS = 0.1;

TEST(Brake, YawRateAndLateralAccelerationLimitTheSpeedOnAnArc) {
  NavigatorParams params;
  params.drive.max_forward_mps = 1.5;
  params.drive.max_yaw_rate_rad_s = 1.4;
  params.drive.max_lateral_mps2 = 0.8;
  const Brake brake(params);
  EXPECT_EQ(brake.speed_limit(0.0, 2.0), 1.5);
  EXPECT_EQ(brake.speed_limit(0.0, 0.3), 0.3);
  EXPECT_NEAR(brake.speed_limit(0.5, 2.0), std::sqrt(1.6), 1e-12);
  EXPECT_NEAR(brake.speed_limit(-7.0, 2.0), 0.2, 1e-12);
  EXPECT_EQ(brake.speed_limit(0.0, -0.5), 0.0);
}

// 4.5 cm beside the body: within the side margin of 6 cm, outside the creep margin of 3 cm.
TEST(Brake, CreepsPastWhatIsWithinTheSideMargin) {
  const NavigatorParams params;
  Situation now;
  now.points_base = {{0.3, 0.5 * params.robot.body.width_m + 0.045}};
  EXPECT_EQ(Brake(params, true).measure_arc(0.0, now).speed_mps, params.drive.creep_mps);
  EXPECT_LT(Brake(params).measure_arc(0.0, now).speed_mps, params.drive.creep_mps);
  now.points_base = {{0.3, 0.5 * params.robot.body.width_m + 0.02}};
  EXPECT_LT(Brake(params, true).measure_arc(0.0, now).speed_mps, params.drive.creep_mps);
}

// 5 cm are left before what is ahead. From v it is stationary after v * 0.1 s + v^2 / 2 / 1.5; at
// 0.2 m/s an emergency stop of 3 m/s^2 takes 6.7 mm.
TEST(Brake, CreepsUpToFiveCentimetresBeforeAnObstacle) {
  const NavigatorParams params;
  const Brake brake(params, true);
  Situation now;
  now.forward_mps = 0.2;
  const auto put_ahead = [&](double distance_m) {
    now.points_base = {{0.5 * params.robot.body.length_m + 0.05 + distance_m, 0.0}};
  };
  put_ahead(0.02);
  const double v = brake.measure_arc(0.0, now).speed_mps;
  EXPECT_NEAR(v * 0.1 + v * v / 3.0, 0.02, 1e-9);
  put_ahead(0.008);
  EXPECT_GT(brake.speed_on_present_arc(now), 0.0);
  put_ahead(0.006);
  EXPECT_EQ(brake.speed_on_present_arc(now), 0.0);
  put_ahead(-0.001);
  EXPECT_EQ(brake.measure_arc(0.0, now).speed_mps, 0.0);
}

// The front is 0.225 m ahead, 0.15 m are left; from 2 m/s an emergency stop takes 0.67 m.
TEST(Brake, StopsAtOnceNearerThanAnEmergencyStopNeeds) {
  const Brake brake(NavigatorParams{});
  const auto speed = [&](double forward_mps, double x_m) {
    Situation now;
    now.forward_mps = forward_mps;
    now.points_base = {{x_m, 0.0}};
    return brake.speed_on_present_arc(now);
  };
  const auto at = [&](double distance_m) { return speed(2.0, 0.225 + 0.15 + distance_m); };
  EXPECT_EQ(at(0.66), 0.0);
  EXPECT_GT(at(0.68), 0.0);
  EXPECT_EQ(speed(0.05, 0.3), kInf);
}

// A body smaller by half a cell, 0.2125 m x 0.1525 m to each side, touches a place behind it at
// radius r once that is at the angle acos(-0.2125 / r). From there on the rate is that of a
// rotation which stops in time: 5 rad/s^2 after 0.1 s.
TEST(Brake, RotatesSlowlyOverGroundThatIsNotKnownToBeFree) {
  const Brake brake(NavigatorParams{});
  const auto rotate = [&](double yaw_rate_rad_s, const Points& doubtful_base) {
    Situation now;
    now.doubtful_base = doubtful_base;
    Decision decision;
    decision.yaw_rate_rad_s = yaw_rate_rad_s;
    brake.keep_to_known_ground(decision, now);
    return decision.yaw_rate_rad_s;
  };
  const Eigen::Vector2d behind(-0.2234, 0.1158);
  const double free_rad = std::atan2(behind.y(), behind.x()) - std::acos(-0.2125 / behind.norm());
  EXPECT_EQ(rotate(1.0, {}), 1.0);
  EXPECT_EQ(rotate(1.0, {{-0.3, 0.1}}), 1.0);  // outside the circle of the corners
  EXPECT_NEAR(rotate(1.0, {behind}), std::sqrt(0.25 + 10.0 * free_rad) - 0.5, 1e-9);
  EXPECT_NEAR(rotate(-1.0, {{0.1, -0.153}}), -deg_to_rad(10.0), 1e-12);  // 0.3 degrees
}

// An arc to the left swings the rear to the right.
TEST(Brake, SwingsItsRearSlowlyOverGroundThatIsNotKnownToBeFree) {
  const Brake brake(NavigatorParams{});
  const auto drive = [&](double curvature, const Eigen::Vector2d& doubtful_base) {
    Situation now;
    now.doubtful_base = {doubtful_base};
    Decision decision;
    decision.forward_mps = 0.3;
    decision.yaw_rate_rad_s = 0.3 * curvature;
    brake.keep_to_known_ground(decision, now);
    EXPECT_NEAR(decision.yaw_rate_rad_s, curvature * decision.forward_mps, 1e-12);
    return decision.forward_mps;
  };
  EXPECT_NEAR(drive(4.0, {-0.15, -0.153}), deg_to_rad(10.0) / 4.0,
              1e-12);  // touches it within 1 mm
  EXPECT_EQ(drive(4.0, {-0.15, 0.25}), 0.3);
  EXPECT_EQ(drive(0.0, {-0.15, -0.17}), 0.3);
}

TEST(SeenDirections, ADirectionIsSeenAfterTwoSweeps) {
  SeenDirections view(deg_to_rad(70));
  view.update(0.0, 10);
  EXPECT_FALSE(view.is_seen(0.0, 2));
  view.update(0.0, 11);
  EXPECT_FALSE(view.is_seen(0.0, 2));
  view.update(0.0, 12);
  EXPECT_TRUE(view.is_seen(0.0, 2));
  EXPECT_TRUE(view.is_seen(deg_to_rad(-69), 2));
  EXPECT_FALSE(view.is_seen(deg_to_rad(80), 2));
}

TEST(SeenDirections, AfterAShortGapOnlyWhatWasSeenBeforeIsStillSeen) {
  SeenDirections view(deg_to_rad(70));
  view.update(0.0, 0);
  view.update(0.0, 1);
  view.update(deg_to_rad(40), 2);
  view.forget_unseen(2);
  view.update(deg_to_rad(40), 3);
  EXPECT_TRUE(view.is_seen(deg_to_rad(-40), 2));  // compass 0: for two sweeps before the gap
  EXPECT_FALSE(view.is_seen(deg_to_rad(40), 2));  // compass 80: came into view just before it
  view.update(deg_to_rad(40), 5);
  EXPECT_TRUE(view.is_seen(deg_to_rad(40), 2));
}

TEST(SeenDirections, ARotationBringsNewDirectionsAndForgetsOldOnes) {
  SeenDirections view(deg_to_rad(70));
  view.update(0.0, 0);
  view.update(0.0, 2);
  view.update(deg_to_rad(100), 2);
  EXPECT_FALSE(view.is_seen(0.0, 2));             // compass 100: new
  EXPECT_TRUE(view.is_seen(deg_to_rad(-60), 2));  // compass 40: seen all along
  view.update(0.0, 2);
  EXPECT_FALSE(view.is_seen(deg_to_rad(-60), 2));  // was out of view in between
  view.update(0.0, 0);                             // the servo driver has restarted
  EXPECT_FALSE(view.is_seen(deg_to_rad(40), 2));
}

TEST(Trail, LeadsBackAlongThePathOfTheRobot) {
  Trail trail(20.0);
  EXPECT_FALSE(trail.path_back({}));
  geometry::SE2 pose;
  for (int i = 0; i < 50; ++i) {  // half a metre on an arc of 1 m to the left
    trail.record(pose);
    pose = pose * geometry::SE2{0.01, 0, 0.01};
  }
  const auto back = trail.path_back(pose);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->rotation_rad, 0.0);
  EXPECT_NEAR(back->curvature, 1.0, 0.02);  // chord for arc
}

TEST(Trail, BackwardsTheBodyStaysOnTheStripItHasDriven) {
  Trail trail(20.0);
  for (int i = 0; i <= 30; ++i) {
    trail.record({0.01 * i, 0.0, 0.0});  // 0.3 m straight ahead
  }
  // 5 cm beyond the first pose the body may still be; the steps are of 3 cm.
  EXPECT_NEAR(trail.distance_backwards({0.3, 0.0, 0.0}, 0.0), 0.33, 0.031);
  // A radius of 0.2 m turns by 10 degrees within 3.5 cm.
  EXPECT_LE(trail.distance_backwards({0.3, 0.0, 0.0}, 5.0), 0.05);
  // It has rotated: the way back is another one.
  for (int i = 0; i <= 18; ++i) {
    trail.record({0.3, 0.0, geometry::deg_to_rad(5.0 * i)});
  }
  EXPECT_LE(trail.distance_backwards({0.3, 0.0, geometry::deg_to_rad(90.0)}, 0.0), 0.05);
  EXPECT_EQ(Trail(20.0).distance_backwards({}, 0.0), 0.0);
}

TEST(Trail, FirstRotatesToTheHeadingAtWhichItCame) {
  Trail trail(20.0);
  for (int i = 0; i <= 10; ++i) {
    trail.record({0.05 * i, 0, 0});
  }
  const auto back = trail.path_back({0.5, 0, deg_to_rad(60)});
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->rotation_rad, deg_to_rad(-60), 1e-9);
}

TEST(Trail, EndsAndJumpsAreNoPath) {
  Trail trail(20.0);
  trail.record({0, 0, 0});
  EXPECT_FALSE(trail.path_back({0.02, 0, 0}));
  EXPECT_FALSE(trail.path_back({1.0, 0, 0}));
  trail.record({0.1, 0, 0});
  trail.forget_ahead({0.05, 0, 0});
  EXPECT_FALSE(trail.path_back({0.05, 0, 0}));
}

// Odometry drifts: what was driven long ago is not where it was, however short the way back is.
TEST(Trail, IsForgottenAfterMuchTravel) {
  Trail trail(20.0);
  const geometry::SE2 end{0.5, 0.0, 0.0};
  for (int i = 0; i <= 50; ++i) {
    trail.move({0.01 * i, 0.0, 0.0});
    trail.record({0.01 * i, 0.0, 0.0});
  }
  const double strip_m = trail.distance_backwards(end, 0.0);
  EXPECT_GT(strip_m, 0.4);
  // To and fro on the spot: 8 m, and 8 m again.
  for (int turns = 1; turns <= 3; ++turns) {
    trail.move({0.5, 0.0, 1.0});
    trail.move(end);
    EXPECT_EQ(trail.distance_backwards(end, 0.0), turns < 3 ? strip_m : 0.0) << turns;
    EXPECT_EQ(trail.path_back(end).has_value(), turns < 3) << turns;
  }
}

TurnInput free_to_turn(double heading_rad) {
  TurnInput input;
  input.heading_rad = heading_rad;
  input.left = input.right = {kInf, kInf};
  return input;
}

TEST(Turn, KeepsTheSideItChose) {
  Turn turn({}, kReactionS);
  TurnInput input = free_to_turn(0.0);
  input.clear_direction_rad = deg_to_rad(-40);
  EXPECT_LT(turn.step(input, 0.0).yaw_rate_rad_s, 0.0);
  input.clear_direction_rad = deg_to_rad(10);
  input.more_room_side = 1.0;
  EXPECT_LT(turn.step(input, 1.0).yaw_rate_rad_s, 0.0);
}

TEST(Turn, ChoosesTheFreeDirectionThenTheRoomThenLeft) {
  const auto first_side = [](double free_deg, double room, double preferred) {
    Turn turn({}, kReactionS);
    TurnInput input = free_to_turn(0.0);
    if (free_deg != 0.0) {
      input.clear_direction_rad = deg_to_rad(free_deg);
    }
    input.more_room_side = room;
    return turn.step(input, preferred).yaw_rate_rad_s > 0.0 ? 1 : -1;
  };
  EXPECT_EQ(first_side(-40, 1, 0), -1);
  EXPECT_EQ(first_side(0, -1, 0), -1);
  EXPECT_EQ(first_side(0, 0, 0), 1);
  EXPECT_EQ(first_side(-40, -1, 1), 1);
}

TEST(Turn, EndsOnlyWhenAheadIsSeenAndTheRobotStationary) {
  using Kind = TurnCommand::Kind;
  Turn turn({}, kReactionS);
  TurnInput input = free_to_turn(0.0);
  EXPECT_EQ(turn.step(input, 0.0).kind, Kind::kTurn);
  input.ahead_is_free = true;
  EXPECT_EQ(turn.step(input, 0.0).kind, Kind::kLook);
  input.ahead_is_seen = true;
  input.yaw_rate_rad_s = 0.5;
  EXPECT_EQ(turn.step(input, 0.0).kind, Kind::kLook);
  input.yaw_rate_rad_s = 0.0;
  EXPECT_EQ(turn.step(input, 0.0).kind, Kind::kFinished);
}

TEST(Turn, AfterAFullRotationItWaitsAndTriesAgain) {
  using Kind = TurnCommand::Kind;
  Turn turn({}, kReactionS);
  TurnInput input = free_to_turn(0.0);
  int steps = 0;
  while (turn.step(input, 0.0).kind == Kind::kTurn && steps < 1000) {
    input.heading_rad = geometry::normalize_angle(input.heading_rad + deg_to_rad(1));
    ++steps;
  }
  EXPECT_NEAR(steps, 360, 1);  // a degree each; rounding
  input.stamp = time::from_utime(4'900'000);
  EXPECT_EQ(turn.step(input, 0.0).kind, Kind::kWait);
  input.stamp = time::from_utime(5'100'000);
  EXPECT_EQ(turn.step(input, 0.0).kind, Kind::kTurn);
}

TEST(Turn, BlockedOnOneSideItTriesTheOtherOnceThenBacksUp) {
  using Kind = TurnCommand::Kind;
  Turn turn({}, kReactionS);
  TurnInput input = free_to_turn(0.0);
  EXPECT_GT(turn.step(input, 1.0).yaw_rate_rad_s, 0.0);
  input.left.free_rotation_rad = 0.01;
  input.right.free_rotation_rad = 1.0;
  EXPECT_LT(turn.step(input, 1.0).yaw_rate_rad_s, 0.0);
  input.left.free_rotation_rad = 1.0;
  input.right.free_rotation_rad = 0.01;
  EXPECT_EQ(turn.step(input, 1.0).kind, Kind::kBackUp);
  input.right.free_rotation_rad = 1.0;  // no better than what was tried
  EXPECT_EQ(turn.step(input, 1.0).kind, Kind::kBackUp);
  input.right.free_rotation_rad = kInf;
  EXPECT_EQ(turn.step(input, 1.0).kind, Kind::kTurn);
}

TEST(Turn, BacksUpFirstWhereNeitherSideLeadsOut) {
  using Kind = TurnCommand::Kind;
  TurnInput input = free_to_turn(0.0);
  input.left.free_rotation_rad = deg_to_rad(31);
  input.right.free_rotation_rad = deg_to_rad(80);
  input.has_path_back = true;
  EXPECT_EQ(Turn({}, kReactionS).step(input, 1.0).kind, Kind::kBackUp);
  // 150 degrees, or as far as a free direction, is enough.
  TurnInput reachable = input;
  reachable.right.to_clear_direction_rad = deg_to_rad(60);
  EXPECT_LT(Turn({}, kReactionS).step(reachable, 1.0).yaw_rate_rad_s, 0.0);
  // No path back: it turns as far as it can.
  input.has_path_back = false;
  EXPECT_GT(Turn({}, kReactionS).step(input, 1.0).yaw_rate_rad_s, 0.0);
}

TEST(Goal, ArrivesWithinToleranceAndStaysArrived) {
  const auto at = [](double distance_m) { return goal_in_base({distance_m, 0}, 0.2); };
  EXPECT_FALSE(has_arrived(at(0.21), false));
  EXPECT_TRUE(has_arrived(at(0.2), false));
  EXPECT_TRUE(has_arrived(at(0.25), true));
  EXPECT_FALSE(has_arrived(at(0.31), true));
}

TEST(Detour, BeginsAtAnObstacleAndEndsNearerToTheGoal) {
  FreeSpace space;
  space.distance_m.fill(5.0);
  Detour detour;
  EXPECT_EQ(detour.direction(space, {}, goal_in_base({3, 0}, 0.2), 1.0), 0.0);
  for (int degree = -40; degree <= 30; ++degree) {
    space.at(degree) = 0.6;
  }
  EXPECT_EQ(detour.direction(space, {}, goal_in_base({3, 0}, 0.2), 1.0), deg_to_rad(31));
  EXPECT_EQ(detour.side(), 1.0);
  // Free again, but no nearer: along the wall on the right.
  space.distance_m.fill(5.0);
  const Points wall{{0.3, -0.5}};
  const auto along = detour.direction(space, wall, goal_in_base({3.5, 0}, 0.2), 1.0);
  ASSERT_TRUE(along);
  EXPECT_LT(*along, 0.0);
  EXPECT_EQ(detour.side(), 1.0);
  EXPECT_EQ(detour.direction(space, wall, goal_in_base({2.5, 0}, 0.2), 1.0), 0.0);
  EXPECT_EQ(detour.side(), 0.0);
}

TEST(Detour, NothingBeyondTheGoalBlocksThePath) {
  FreeSpace space;
  space.distance_m.fill(0.6);
  Detour detour;
  EXPECT_EQ(detour.direction(space, {}, goal_in_base({0.5, 0}, 0.1), 1.0), 0.0);
}

TEST(Staleness, EachInputHasItsLimit) {
  const StalenessParams limits;
  const time::Timestamp now(1s);
  const InputStamps fresh{now, now - 10ms, now - 10ms, now - 10ms, now - 10ms};
  EXPECT_FALSE(reason_to_halt(fresh, limits, true));
  const auto with = [&](auto member, std::optional<time::Timestamp> stamp) {
    InputStamps stamps = fresh;
    stamps.*member = stamp;
    return reason_to_halt(stamps, limits, true).has_value();
  };
  EXPECT_FALSE(with(&InputStamps::map, time::from_utime(900'000)));
  EXPECT_TRUE(with(&InputStamps::map, time::from_utime(899'999)));
  EXPECT_FALSE(with(&InputStamps::scan, time::from_utime(900'000)));
  EXPECT_TRUE(with(&InputStamps::scan, time::from_utime(899'999)));
  EXPECT_TRUE(with(&InputStamps::pitch_command, time::from_utime(849'999)));
  EXPECT_TRUE(with(&InputStamps::pitch_state, time::from_utime(849'999)));
  // Odometry that stays behind, or an input from the future.
  EXPECT_TRUE(with(&InputStamps::odometry, time::from_utime(880'000)));
  EXPECT_TRUE(with(&InputStamps::map, time::from_utime(1'100'001)));
  for (const auto member : {&InputStamps::odometry, &InputStamps::map, &InputStamps::scan,
                            &InputStamps::pitch_command, &InputStamps::pitch_state}) {
    EXPECT_TRUE(with(member, std::nullopt));
  }
}

TEST(Staleness, WithoutTheLocalMapNoScanIsNeeded) {
  const time::Timestamp now(1s);
  InputStamps stamps{now, now - 10ms, now - 10ms, now - 10ms, now - 10ms};
  stamps.scan.reset();
  EXPECT_FALSE(reason_to_halt(stamps, {}, false));
  EXPECT_EQ(reason_to_halt(stamps, {}, true), Reason(Why::kNoInput, "scan for the local map"));
}

TEST(ObstaclePoints, AnInconsistentMapIsRefused) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  constexpr auto kFar = std::numeric_limits<float>::infinity();
  using Bins = std::vector<float>;
  const auto points = read_points(Bins{kFar, 5.0F}, Bins{kNone, 3.0F}, Bins{kNone, 4.0F});
  ASSERT_TRUE(points);
  EXPECT_EQ(*points, (Points{{3.0, 4.0}}));
  EXPECT_FALSE(read_points(Bins{kNone}, Bins{1.0F}, Bins{0.0F}));
  EXPECT_FALSE(read_points(Bins{1.0F}, Bins{kNone}, Bins{0.0F}));
  EXPECT_FALSE(read_points(Bins{-1.0F}, Bins{1.0F}, Bins{0.0F}));
  EXPECT_FALSE(read_points(Bins{-kFar}, Bins{kNone}, Bins{kNone}));
  EXPECT_FALSE(read_points(Bins{2.0F}, Bins{1.0F}, Bins{0.0F}));
  EXPECT_FALSE(read_points(Bins{1.0F, 1.0F}, Bins{1.0F}, Bins{0.0F}));
  EXPECT_FALSE(read_points({}, {}, {}));
}

TEST(ObstaclePoints, ARobotThatTurnedRightSeesThePointOnItsLeft) {
  const auto points = move_to_base({{2.0, 0.0}}, {1, 1, 0}, {1, 1, deg_to_rad(-30)});
  EXPECT_NEAR(points[0].x(), 2.0 * std::cos(deg_to_rad(30)), 1e-12);
  EXPECT_NEAR(points[0].y(), 1.0, 1e-12);
  EXPECT_NEAR(move_to_base({{2.0, 0.0}}, {1, 1, 0}, {1.5, 1, 0})[0].x(), 1.5, 1e-12);
}

}  // namespace behaviours_test
}  // namespace nodmap::navigator
