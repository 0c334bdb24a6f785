// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/behaviours/brake.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "modules/navigator/local_map/test/scanned_ground.hpp"

namespace nodmap::navigator {
namespace brake_test {

using geometry::deg_to_rad;

constexpr double kInf = std::numeric_limits<double>::infinity();

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

// The wall is 4.5 cm beside the body: within the side margin of 6 cm, outside the creep margin of 3
// cm.
TEST(Brake, CreepsPastAnObstacleWithinTheSideMargin) {
  const NavigatorParams params;
  Situation now;
  now.points_base = {{0.3, 0.5 * params.robot.body.width_m + 0.045}};
  EXPECT_EQ(Brake(params, true).measure_arc(0.0, now).speed_mps, params.drive.creep_mps);
  EXPECT_LT(Brake(params).measure_arc(0.0, now).speed_mps, params.drive.creep_mps);
  now.points_base = {{0.3, 0.5 * params.robot.body.width_m + 0.02}};
  EXPECT_LT(Brake(params, true).measure_arc(0.0, now).speed_mps, params.drive.creep_mps);
}

// 5 cm remain before the obstacle ahead. From v the robot is stationary after v * 0.1 s + v^2 / 2 /
// 1.5; at 0.2 m/s an emergency stop of 3 m/s^2 takes 6.7 mm.
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

// The front is at 0.225 m, so 0.15 m remain; from 2 m/s an emergency stop takes 0.67 m.
TEST(Brake, StopsAtOnceIfEvenAnEmergencyStopWouldBeTooLong) {
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

// At 1 m/s and 0.8 rad/s the wheels are 0.2 m beside the centre, so the outer one drives 1.16 m/s.
// Where it loses 3 m/s^2, the centre loses 2.59 and stops after 0.193 m, not after 0.167 m.
TEST(Brake, OnAnArcAnEmergencyStopTakesLonger) {
  const Brake brake(NavigatorParams{});
  Situation now;
  now.forward_mps = 1.0;
  now.yaw_rate_rad_s = 0.8;
  const auto speed = [&](double x_m) {
    now.points_base = {{x_m, 0.06}};
    return brake.speed_on_present_arc(now);
  };
  const auto free_m = [&](double x_m) {
    now.points_base = {{x_m, 0.06}};
    return brake.measure_arc(0.8, now).free_distance_m - 0.15;
  };
  EXPECT_GT(free_m(0.56), 0.17);
  EXPECT_EQ(speed(0.56), 0.0);
  EXPECT_GT(free_m(0.58), 0.195);
  EXPECT_GT(speed(0.58), 0.0);
}

// The robot rotates at 0.45 rad/s and begins to drive. On its arc, with a radius of 0.16 m, the
// front left corner comes to an obstacle beside the body after 0.11 m: that is less than the margin
// of 0.15 m, but a robot at 0.07 m/s needs no such margin. At 0.3 m/s, on the same arc, it does.
TEST(Brake, ASlowRobotThatHasRotatedMayDriveOn) {
  const Brake brake(NavigatorParams{});
  Situation now;
  now.points_base = {{0.1, 0.33}};
  const auto speed = [&](double forward_mps) {
    now.forward_mps = forward_mps;
    now.yaw_rate_rad_s = forward_mps / 0.16;
    return brake.speed_on_present_arc(now);
  };
  EXPECT_GT(speed(0.07), 0.07);
  EXPECT_LE(speed(0.07), DriveParams{}.creep_mps);
  EXPECT_EQ(speed(0.3), 0.0);
}

TEST(Brake, DrivesAnArcAsFastAsLimitGoalAndObstaclesAllow) {
  const Brake brake(NavigatorParams{});
  const Arc arc{.curvature = 0.5, .free_distance_m = 2.0, .stop_margin_m = 0.15, .speed_mps = 0.8};
  Situation now;
  const Decision slowed = brake.drive(arc, 0.1, 1.0, now);
  EXPECT_EQ(slowed.behaviour, Behaviour::kBrake);
  EXPECT_EQ(slowed.reason, Reason(Why::kSlowsDown));
  EXPECT_EQ(slowed.forward_mps, 0.8);
  EXPECT_EQ(slowed.yaw_rate_rad_s, 0.4);
  EXPECT_EQ(slowed.max_forward_mps, 0.8);
  EXPECT_EQ(slowed.free_distance_m, 2.0);
  const Decision limited = brake.drive(arc, 0.1, 0.6, now);
  EXPECT_EQ(limited.behaviour, Behaviour::kSteer);
  EXPECT_EQ(limited.forward_mps, 0.6);
  EXPECT_EQ(limited.max_forward_mps, 0.6);
  now.goal = GoalInBase{{0.05, 0.0}, 0.01};
  EXPECT_EQ(brake.drive(arc, 0.1, 1.0, now).forward_mps, brake.stoppable_mps(0.05));
  EXPECT_EQ(brake.drive(arc, 0.1, 1.0, now).max_forward_mps, 0.8);
  now.goal = GoalInBase{{5.0, 0.0}, 0.01};
  EXPECT_EQ(brake.drive(arc, 0.1, 0.6, now).forward_mps, 0.6);
  // On its present arc, straight ahead, is an obstacle, whatever the other arc is like.
  now.goal.reset();
  now.forward_mps = 1.0;
  now.points_base = {{0.4, 0.0}};
  EXPECT_EQ(brake.drive(arc, 0.1, 1.0, now).forward_mps, 0.0);
}

TEST(Brake, RotatesNoFasterThanTurnMay) {
  EXPECT_EQ(Brake(NavigatorParams{}).stoppable_rad_s(10.0), TurnParams{}.rate_rad_s);
}

// An angle w T + w^2 / 2a, with the deceleration of the base.
TEST(Brake, ABaseThatBrakesRotationsMoreSlowlyRotatesMoreSlowly) {
  for (const double deceleration_rad_s2 : {1.0, 3.0}) {
    NavigatorParams params;
    params.base.rotation_deceleration_rad_s2 = deceleration_rad_s2;
    const double rad_s = Brake(params).stoppable_rad_s(0.2);
    EXPECT_LT(rad_s, TurnParams{}.rate_rad_s);
    EXPECT_NEAR(rad_s * params.drive.reaction_s + rad_s * rad_s / (2.0 * deceleration_rad_s2), 0.2,
                1e-12);
  }
}

// The ground drops at `from_m`, up to `until_m`. Floor counts as seen from blind_m on, 0.44 m ahead
// of base, and ends at most one line before the drop: 5 cm, and two cells.
TEST(Brake, DrivesNoFasterThanItCanStopOnSeenFloor) {
  const NavigatorParams params;
  const Brake brake(params);
  constexpr double kBlindM = 0.44;
  const auto speed_before = [&](double from_m, double until_m, bool is_held) {
    LocalMap map(params.robot, params.local_map);
    test::sweep(map, {{{{from_m, -3.0}, {until_m, 3.0}, -1.5}}}, {}, 1.0);
    Situation now;
    now.local_map = &map;
    now.laser_is_held = is_held;
    return brake.measure_arc(0.0, now).speed_mps;
  };
  const auto expect_to_stop_within = [&](double speed_mps, double distance_m, double deceleration) {
    EXPECT_LE(speed_mps, robot::stoppable_speed(distance_m + 0.025, 0.1, deceleration));
    EXPECT_GE(speed_mps, robot::stoppable_speed(distance_m - 0.1, 0.1, deceleration));
  };
  expect_to_stop_within(speed_before(1.0, 6.0, false), 1.0 - kBlindM, 1.5);
  // Shorter than the wide gap, and longer than the greatest: with all of its brakes' force.
  expect_to_stop_within(speed_before(0.8, 1.0, false), 0.8 - kBlindM, 3.0);
  EXPECT_EQ(speed_before(1.0, 6.0, true), kInf) << "a laser that is held sees no floor";
}

// The corridor is 0.165 m + 0.06 m + 0.1 m wide to each side. The front is at 0.225 m, and 0.15 m
// remain.
TEST(Brake, StopsBeforeWhatMayBeARampDownOrAHole) {
  const NavigatorParams params;
  Situation now;
  for (const bool creeps : {false, true}) {
    const Brake brake(params, creeps);
    now.possible_ramps_down_base = {{1.0, 0.32}};
    EXPECT_EQ(brake.measure_arc(0.0, now).speed_mps, brake.stoppable_mps(1.0 - 0.225 - 0.15));
    now.possible_ramps_down_base = {{1.0, 0.33}, {-0.5, 0.0}};
    EXPECT_EQ(brake.measure_arc(0.0, now).speed_mps, kInf);
    now.possible_ramps_down_base = {{0.37, 0.1}};
    EXPECT_EQ(brake.measure_arc(0.0, now).speed_mps, 0.0);
  }
}

// A body smaller by half a cell, 0.2125 m x 0.1525 m to each side, touches a place behind it at
// radius r after a rotation to the angle acos(-0.2125 / r). The allowed yaw rate is that at which
// the robot stops before that angle: 5 rad/s^2, after a reaction time of 0.1 s.
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
  EXPECT_EQ(rotate(1.0, {{-0.3, 0.1}}), 1.0);  // the corners do not reach it
  EXPECT_NEAR(rotate(1.0, {behind}), std::sqrt(0.25 + 10.0 * free_rad) - 0.5, 1e-9);
  EXPECT_NEAR(rotate(-1.0, {{0.1, -0.153}}), -deg_to_rad(10.0), 1e-12);  // 0.3 degrees remain
  EXPECT_NEAR(rotate(-deg_to_rad(15.0), {{0.1, -0.153}}), -deg_to_rad(10.0), 1e-12);
}

// The robot turns right past ground at which its laser has never looked.
TEST(Brake, GroundAtWhichTheLaserHasNeverLookedIsAnObstacle) {
  const Brake brake(NavigatorParams{});
  const Points points = {{0.4, -0.3}};
  Situation never_looked;
  never_looked.unseen_ahead_base = points;
  Situation obstacle;
  obstacle.points_base = points;
  for (const double curvature : {0.0, -1.5}) {
    const Arc arc = brake.measure_arc(curvature, never_looked);
    EXPECT_EQ(arc.free_distance_m, brake.measure_arc(curvature, obstacle).free_distance_m);
    EXPECT_EQ(arc.speed_mps, brake.measure_arc(curvature, obstacle).speed_mps);
    EXPECT_EQ(arc.free_distance_m < 0.3, curvature != 0.0);
  }
}

// An arc to the left swings the rear to the right.
TEST(Brake, SwingsItsRearSlowlyOverGroundThatIsNotKnownToBeFree) {
  const Brake brake(NavigatorParams{});
  const auto drive = [&](double curvature, const Eigen::Vector2d& doubtful_base) {
    Situation now;
    now.doubtful_base = {doubtful_base};
    Decision decision;
    decision.forward_mps = decision.max_forward_mps = 0.3;
    decision.yaw_rate_rad_s = 0.3 * curvature;
    brake.keep_to_known_ground(decision, now);
    EXPECT_EQ(decision.max_forward_mps, decision.forward_mps);
    EXPECT_NEAR(decision.yaw_rate_rad_s, curvature * decision.forward_mps, 1e-12);
    return decision.forward_mps;
  };
  EXPECT_NEAR(drive(4.0, {-0.15, -0.153}), deg_to_rad(10.0) / 4.0,
              1e-12);  // touched after 1 mm
  EXPECT_EQ(drive(4.0, {-0.15, 0.25}), 0.3);
  EXPECT_EQ(drive(0.0, {-0.15, -0.17}), 0.3);
  // Beside the front, on the inner side; but ahead of the body seen floor counts instead.
  EXPECT_NEAR(drive(4.0, {0.1, 0.153}), deg_to_rad(10.0) / 4.0, 1e-12);
  EXPECT_EQ(drive(4.0, {0.3, 0.1}), 0.3);
}

// The base has done what is commanded after 0.07 s, in which ordinary brakes take 0.105 m/s.
TEST(Brake, SlowsDownWithOrdinaryBrakesOnItsArc) {
  const Brake brake{NavigatorParams{}};
  Situation now;
  now.max_forward_mps = 1.5;
  const auto slow_down = [&](double forward_mps, double yaw_rate_rad_s) {
    now.forward_mps = forward_mps;
    now.yaw_rate_rad_s = yaw_rate_rad_s;
    return brake.slow_down(Why::kPlans, now);
  };
  const Decision decision = slow_down(1.0, 0.5);
  EXPECT_EQ(decision.reason, Reason(Why::kPlans));
  EXPECT_NEAR(decision.forward_mps, 1.0 - 0.105, 1e-12);
  EXPECT_NEAR(decision.yaw_rate_rad_s, 0.5 * decision.forward_mps, 1e-12);
  EXPECT_EQ(decision.max_forward_mps, decision.forward_mps);
  EXPECT_EQ(slow_down(0.1, -0.3).forward_mps, 0.0);
  for (const double slow_mps : {0.05, 0.0, -0.1}) {
    EXPECT_EQ(slow_down(slow_mps, 1.0).forward_mps, 0.0);
    EXPECT_EQ(slow_down(slow_mps, 1.0).yaw_rate_rad_s, 0.0);
  }
  now.max_forward_mps = 0.4;
  EXPECT_EQ(slow_down(1.0, 0.0).forward_mps, 0.4) << "the pitch controller's bound";
  now.max_forward_mps = 0.05;
  EXPECT_EQ(slow_down(1.0, 0.0).forward_mps, 0.0);
}

// From 1 m/s an ordinary stop takes 0.43 m, and an emergency stop 0.17 m. The front is at 0.225 m,
// and 0.15 m remain.
TEST(Brake, SlowsDownAsFastAsItsArcRequires) {
  const Brake brake{NavigatorParams{}};
  Situation now;
  now.forward_mps = now.max_forward_mps = 1.0;
  const auto forward_mps = [&](double stop_m) {
    now.points_base = {{0.225 + 0.15 + stop_m, 0.0}};
    return brake.slow_down(Why::kPlans, now).forward_mps;
  };
  EXPECT_NEAR(forward_mps(0.44), 1.0 - 0.105, 1e-12);
  EXPECT_NEAR(forward_mps(0.3), brake.stoppable_mps(0.3), 1e-9);
  EXPECT_LT(forward_mps(0.3), 1.0 - 0.105);
  EXPECT_EQ(forward_mps(0.16), 0.0);
}

// What is left of the command to steer at 0.7 m/s in a curve, given who is there.
Decision give_way(double present_mps, const People& people) {
  Situation now;
  now.forward_mps = present_mps;
  now.people = people;
  Decision decision;
  decision.behaviour = Behaviour::kSteer;
  decision.forward_mps = decision.max_forward_mps = 0.7;
  decision.yaw_rate_rad_s = 0.07;
  Brake(NavigatorParams{}).give_way(decision, now);
  return decision;
}

// From 0.7 m/s an emergency stop takes 0.33 s; he is there after 0.3 s.
TEST(Brake, StopsIfItIsTooLateToStopBeforeSomebodyTouchesIt) {
  const Decision decision = give_way(0.7, {{{1.0, 0.0}, {-1.4, 0.0}, 0.25}});
  EXPECT_EQ(decision.behaviour, Behaviour::kBrake);
  EXPECT_EQ(decision.reason, Reason(Why::kGivesWay));
  EXPECT_EQ(decision.forward_mps, 0.0);
  EXPECT_EQ(decision.yaw_rate_rad_s, 0.0);
  EXPECT_EQ(decision.max_forward_mps, 0.0);
}

// He stands 0.2 m ahead of the body and its margin: enough to stop from 0.6 m/s, not from 0.7 m/s.
// So a robot that already is so fast brakes, but does not stop: an emergency stop takes 0.15 m.
TEST(Brake, SlowsDownOnItsArcAsFarAsSomebodyAheadRequires) {
  const NavigatorParams params;
  const double margins_m = 0.5 * params.robot.body.length_m + 0.25 + params.people.margin_m;
  const auto ahead = [&](double free_m) {
    return People{{{margins_m + free_m, 0.0}, {0.0, 0.0}, 0.25}};
  };
  const Decision slower = give_way(0.3, ahead(0.2));
  EXPECT_EQ(slower.reason, Reason(Why::kGivesWay));
  EXPECT_GT(slower.forward_mps, 0.3);
  EXPECT_LT(slower.forward_mps, 0.6);
  EXPECT_NEAR(slower.yaw_rate_rad_s, 0.1 * slower.forward_mps, 1e-12) << "the same curve";
  EXPECT_EQ(slower.max_forward_mps, slower.forward_mps);
  EXPECT_EQ(give_way(0.7, ahead(0.2)).forward_mps, slower.forward_mps);
  EXPECT_EQ(give_way(0.7, ahead(0.12)).forward_mps, 0.0);
}

// Nobody is near; or somebody from the side walks behind a robot that drives on, but into one that
// stops.
TEST(Brake, DoesNotGiveWayToWhomItEscapesOrDoesNotMeet) {
  for (const People& people : {People{}, People{{{10.0, 0.0}, {-1.4, 0.0}, 0.25}},
                               People{{{0.1, 1.2}, {0.0, -1.0}, 0.25}}}) {
    const Decision decision = give_way(0.7, people);
    EXPECT_EQ(decision.behaviour, Behaviour::kSteer);
    EXPECT_EQ(decision.forward_mps, 0.7);
    EXPECT_EQ(decision.yaw_rate_rad_s, 0.07);
  }
}

// Somebody crosses. Where a stop would be no help, the robot goes on.
TEST(Brake, KeepsAMotionThatTakesItOutOfSomebodysWay) {
  const NavigatorParams params;
  const PassiveSafety safety(params);
  int num_escapes = 0;
  for (const double present_mps : {0.3, 0.7}) {
    for (double x = -0.2; x < 1.0; x += 0.1) {
      for (double y = 0.5; y < 1.5; y += 0.1) {
        const People crossing{{{x, y}, {0.0, -1.0}, 0.25}};
        const bool escapes = safety.escapes({present_mps, 0.0}, {0.7, 0.07}, crossing);
        const bool is_safe = safety.can_stop({present_mps, 0.0}, crossing) &&
                             safety.safe_factor({0.7, 0.07}, crossing) == 1.0;
        const Decision decision = give_way(present_mps, crossing);
        EXPECT_EQ(decision.forward_mps == 0.7, escapes || is_safe) << x << ' ' << y;
        num_escapes += escapes && !is_safe ? 1 : 0;
      }
    }
  }
  EXPECT_GT(num_escapes, 0);
}

}  // namespace brake_test
}  // namespace nodmap::navigator
