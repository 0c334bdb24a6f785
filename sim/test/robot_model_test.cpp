// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/robot_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/test/host.hpp"
#include "sim/test/wall_ahead.hpp"

namespace nodmap::sim {
namespace robot_model_test {

using geometry::deg_to_rad;
using test::at;
using test::wall_ahead;

// A robot without noise or slip.
RobotModelParams exact_params() {
  RobotModelParams params;
  params.drive.slip_distance_m = 0.0;
  params.drive.slip_heading_rad = 0.0;
  params.drive.slip_turning_rad = 0.0;
  params.laser.range_sigma_m = 0.0;
  params.drive.tilt_per_mps2_rad = 0.0;
  params.drive.ground_tilt_rad = 0.0;
  return params;
}

Actor walker(std::vector<Waypoint> path) {
  Actor actor;
  actor.path = std::move(path);
  return actor;
}

// The measurements of a drive with the laser running.
std::vector<double> drive(std::uint64_t seed) {
  RobotModel model(wall_ahead(8.0), {}, seed);
  model.set_wheel_speeds({0.8, 1.0});
  model.set_pitch_goal({0.2, 1.0, 20.0});
  std::vector<double> numbers;
  for (time::SteadyTime now{}; now < at(2s); now += 13'320us) {
    model.advance_to(now);
    for (int beam = -90; beam <= 90; beam += 30) {
      numbers.push_back(model.measure(deg_to_rad(beam), now - 5ms).range_m);
    }
    const GroundTruth truth = model.ground_truth();
    numbers.push_back(truth.T_world_base.translation().x());
    numbers.push_back(truth.T_world_base.translation().y());
    numbers.push_back(truth.pitch_rad);
  }
  return numbers;
}

TEST(RobotModel, TheSameSeedGivesTheSameNumbersAndAnotherSeedOthers) {
  EXPECT_EQ(drive(7), drive(7));
  EXPECT_NE(drive(7), drive(8));
}

TEST(RobotModel, AStationaryRobotCountsNoTravelAndNoCollision) {
  RobotModel model(wall_ahead(2.0), {}, 1);
  model.advance_to(at(10s));
  EXPECT_EQ(model.wheel_travel().left_m, 0.0);
  EXPECT_EQ(model.wheel_travel().right_m, 0.0);
  EXPECT_TRUE(model.ground_truth().T_world_base.isApprox(geometry::SE3::Identity()));
  EXPECT_EQ(model.ground_truth().contacts.collisions, 0);
}

TEST(RobotModel, RangesAreMeasuredFromThePitchAxis) {
  RobotModel model(wall_ahead(3.0), exact_params(), 1);
  model.advance_to(at(100ms));
  // 2.85 m from the axis; the spot's border is farther away by 2.85 * (0.25 / 2 degrees)^2 / 2 = 7
  // um.
  EXPECT_NEAR(model.measure(0.0, at(100ms)).range_m, 2.85, 7e-6);
  // Here and below the tolerance is 1.25 times the measured error: the mean over an oblique spot is
  // longer.
  EXPECT_NEAR(model.measure(deg_to_rad(60.0), at(100ms)).range_m, 5.7, 8.8e-5);
  model.set_pitch_goal({deg_to_rad(-20.0), 0.0, 0.0});
  model.advance_to(at(1s));
  // The floor: the range is the mean over a spot that is long and flat.
  EXPECT_NEAR(model.measure(0.0, at(1s)).range_m, 0.38 / std::sin(deg_to_rad(20.0)), 2.3e-4);
}

TEST(RobotModel, MeasuresTheWorldAtAPastTime) {
  RobotModel model(wall_ahead(10.0), exact_params(), 1);
  model.set_wheel_speeds({1.0, 1.0});
  model.advance_to(at(3s));
  const double now_m = model.measure(0.0, at(3s)).range_m;
  // The robot drives at 1 m/s; the motors' lag is over. The mean over the spot is longer by 1.1 um
  // per metre.
  EXPECT_NEAR(model.measure(0.0, at(3s - 100ms)).range_m, now_m + 0.1, 1.5e-7);
  EXPECT_NEAR(model.measure(0.0, at(3s - 12'345us)).range_m, now_m + 0.012345, 1.5e-7);
  EXPECT_THROW(static_cast<void>(model.measure(0.0, at(3s + 1us))), std::out_of_range);
  EXPECT_THROW(static_cast<void>(model.measure(0.0, at(2s))), std::out_of_range);
  EXPECT_THROW(model.advance_to(at(1s)), std::invalid_argument);
}

TEST(RobotModel, MeasuresActorsWhereTheyWereAtThatTime) {
  World world;
  world.actors.push_back(walker({{0.0, {4.0, -2.0}}, {4.0, {4.0, 2.0}}}));
  RobotModel model(world, exact_params(), 1);
  model.advance_to(at(2s));
  // Some rays of the spot hit the round actor beside its nearest line, 0.08 mm farther away.
  EXPECT_NEAR(model.measure(0.0, at(2s)).range_m, 4.0 - 0.25 - 0.15, 1.1e-4);
  model.advance_to(at(2s + 500ms));
  EXPECT_EQ(model.measure(0.0, at(2s + 500ms)).kind, Echo::Kind::kNothing);
}

TEST(RobotModel, AWallStopsTheRobotAndCountsAsOneCollision) {
  RobotModelParams params = exact_params();
  params.drive.tilt_per_mps2_rad = deg_to_rad(0.1);
  RobotModel model(wall_ahead(1.0), params, 1);
  model.set_wheel_speeds({0.5, 0.5});
  model.advance_to(at(5s));
  const GroundTruth truth = model.ground_truth();
  EXPECT_EQ(truth.contacts.collisions, 1);
  // A step at 0.5 m/s is half a millimetre long.
  EXPECT_NEAR(truth.T_world_base.translation().x(), 1.0 - 0.225, 6e-4);
  EXPECT_NEAR(truth.clearance_m, 0.0, 6e-4);
  EXPECT_EQ(truth.forward_mps, 0.0);
  EXPECT_GT(model.wheel_travel().left_m, 2.0);                // the wheels slip
  EXPECT_NEAR(truth.T_world_base.linear()(2, 2), 1.0, 1e-6);  // and the body is level

  model.set_wheel_speeds({-0.5, -0.5});
  model.advance_to(at(7s));
  EXPECT_GT(model.ground_truth().clearance_m, 0.5);
  model.set_wheel_speeds({0.5, 0.5});
  model.advance_to(at(12s));
  EXPECT_EQ(model.ground_truth().contacts.collisions, 2);
}

TEST(RobotModel, AnActorWhoWalksIntoTheStationaryRobotCountsAsABump) {
  World world;
  world.actors.push_back(walker({{1.0, {2.0, 0.0}}, {4.0, {0.3, 0.0}}, {7.0, {2.0, 0.0}}}));
  RobotModel stationary(world, exact_params(), 1);
  stationary.advance_to(at(8s));
  EXPECT_EQ(stationary.ground_truth().contacts.bumps, 1);
  EXPECT_EQ(stationary.ground_truth().contacts.collisions, 0);

  RobotModel driving(world, exact_params(), 1);
  driving.set_wheel_speeds({0.1, 0.1});
  driving.advance_to(at(5s));
  EXPECT_EQ(driving.ground_truth().contacts.bumps, 0);
  EXPECT_EQ(driving.ground_truth().contacts.collisions, 1);
}

// Somebody who walks from (2, y) to `end` within a second, and stays there.
World somebody_who_walks_to(const Eigen::Vector2d& end) {
  World world;
  world.actors.push_back(walker({{0.0, {2.0, end.y()}}, {1.0, end}}));
  return world;
}

void wait_until_bumped(RobotModel& model) {
  model.advance_to(at(2s));
  ASSERT_EQ(model.ground_truth().contacts.bumps, 1);
  ASSERT_EQ(model.ground_truth().contacts.collisions, 0);
}

double yaw_rad(const RobotModel& model) {
  return geometry::to_se2(model.ground_truth().T_world_base).yaw;
}

constexpr double kPersonRadiusM = 0.25;
constexpr double kOverlapM = 1e-3;

// In a rotation to the left the front left corner moves to the left, and the front left of centre
// moves back.
TEST(RobotModel, ARobotThatTurnsItsCornerIntoSomebodyWhoBumpedItCollides) {
  RobotModel model(somebody_who_walks_to({0.2, 0.165 + kPersonRadiusM - kOverlapM}), exact_params(),
                   1);
  wait_until_bumped(model);
  model.set_wheel_speeds({-0.15, 0.15});
  model.advance_to(at(4s));
  EXPECT_EQ(model.ground_truth().contacts.collisions, 1);
  EXPECT_EQ(model.ground_truth().contacts.contacts_caused, 1);
  EXPECT_EQ(yaw_rad(model), 0.0);
}

TEST(RobotModel, ARobotMayTurnAwayFromSomebodyWhoBumpedIt) {
  RobotModel model(somebody_who_walks_to({0.225 + kPersonRadiusM - kOverlapM, 0.1}), exact_params(),
                   1);
  wait_until_bumped(model);
  model.set_wheel_speeds({-0.15, 0.15});
  model.advance_to(at(2300ms));
  EXPECT_EQ(model.ground_truth().contacts.collisions, 0);
  // 0.3 m/s between the wheels, 0.28 m apart, of which 0.69 turn the robot: 0.74 rad/s for 0.3 s
  // less the motors' lag of 50 ms.
  EXPECT_NEAR(yaw_rad(model), 0.3 / 0.28 * 0.69 * 0.25, 0.002);
}

TEST(RobotModel, ARobotMayBackOutOfSomebodyWhoStandsInIt) {
  RobotModel model(somebody_who_walks_to({0.15, 0.0}), exact_params(), 1);
  wait_until_bumped(model);
  model.set_wheel_speeds({0.15, 0.15});
  model.advance_to(at(3s));
  EXPECT_EQ(model.ground_truth().T_world_base.translation().x(), 0.0);
  EXPECT_EQ(model.ground_truth().contacts.collisions, 1);
  model.set_wheel_speeds({-0.15, -0.15});
  model.advance_to(at(5s));
  EXPECT_LT(model.ground_truth().T_world_base.translation().x(), -0.25);
}

TEST(RobotModel, ActorsAppearAndVanish) {
  World world;
  Actor actor = walker({{0.0, {2.0, 0.0}}});
  actor.appear_s = 1.0;
  actor.vanish_s = 2.0;
  world.actors.push_back(actor);
  RobotModel model(world, exact_params(), 1);
  model.advance_to(at(1s - 10ms));
  EXPECT_TRUE(model.ground_truth().actors.empty());
  model.advance_to(at(1s + 10ms));
  ASSERT_EQ(model.ground_truth().actors.size(), 1U);
  EXPECT_NEAR(model.ground_truth().clearance_m, 2.0 - 0.225 - 0.25, 1e-12);
  model.advance_to(at(2s + 10ms));
  EXPECT_TRUE(model.ground_truth().actors.empty());
}

TEST(RobotModel, APitStopsTheRobotAndCountsAsACollision) {
  World world;
  world.pits.push_back({{1.0, -1.0}, {3.0, 1.0}, 0.5});
  RobotModel model(world, exact_params(), 1);
  model.set_wheel_speeds({0.5, 0.5});
  model.advance_to(at(5s));
  EXPECT_EQ(model.ground_truth().contacts.collisions, 1);
  EXPECT_EQ(model.ground_truth().contacts.falls, 1);
  EXPECT_EQ(model.ground_truth().contacts.contacts_caused, 1);
  // A step of a millisecond at 0.5 m/s.
  EXPECT_NEAR(model.ground_truth().T_world_base.translation().x(), 1.0 - 0.225, 5e-4);
}

TEST(RobotModel, DrivesUpARampAndStopsAtItsEnd) {
  World world;
  world.objects.push_back({Ramp{{1.0, 0.0, 0.0}, {4.0, 0.0, 0.5}, 2.0}});
  RobotModel model(world, exact_params(), 1);
  model.set_wheel_speeds({1.0, 1.0});
  model.advance_to(at(2500ms));
  const GroundTruth truth = model.ground_truth();
  EXPECT_EQ(truth.contacts.collisions, 0);
  const Eigen::Vector3d p = truth.T_world_base.translation();
  // On the slope, and tilted like it. The line between the wheels differs from the ramp only at its
  // foot.
  EXPECT_NEAR(p.z(), (p.x() - 1.0) / 6.0, 1e-6);
  EXPECT_NEAR(truth.T_world_base.linear()(2, 0), 0.5 / std::hypot(3.0, 0.5), 1e-6);
  model.advance_to(at(10s));
  EXPECT_EQ(model.ground_truth().contacts.falls, 1);
  // The front wheels, half of the wheelbase ahead of base, stop at the edge. Tolerance: a step at 1
  // m/s, 1 mm.
  EXPECT_NEAR(model.ground_truth().T_world_base.translation().x(), 4.0 - 0.15, 1e-3);
}

// With the front wheels on the slope and the rear ones on the floor, the pitch is the height of the
// front wheels divided by the wheelbase.
TEST(RobotModel, PitchGrowsWhileTheWheelsRollOntoARamp) {
  const double slope = std::tan(deg_to_rad(12.0));
  World world;
  world.objects.push_back({Ramp{{1.0, 0.0, 0.0}, {4.0, 0.0, 3.0 * slope}, 2.0}});
  RobotModel model(world, exact_params(), 1);
  model.set_wheel_speeds({0.2, 0.2});
  time::Duration t{};
  while (model.ground_truth().T_world_base.translation().x() < 1.0) {
    model.advance_to(at(t += 1ms));
  }
  const GroundTruth truth = model.ground_truth();
  const double front_m = slope * (truth.T_world_base.translation().x() + 0.15 - 1.0);
  EXPECT_NEAR(truth.T_world_base.linear()(2, 0), std::sin(std::atan2(front_m, 0.3)), 1e-12);
  EXPECT_NEAR(truth.T_world_base.translation().z(), 0.5 * front_m, 1e-12);  // rounding
  EXPECT_EQ(truth.contacts.collisions, 0);
}

TEST(RobotModel, AWheelBeyondTheSideOfARampCountsAsAFall) {
  World world;
  world.objects.push_back({Ramp{{1.0, 0.0, 0.0}, {5.0, 0.0, 0.7}, 1.0}});
  RobotModel model(world, exact_params(), 1);
  model.set_wheel_speeds({0.5, 0.5});
  model.advance_to(at(5s));
  model.set_wheel_speeds({0.4, 0.5});
  model.advance_to(at(12s));
  EXPECT_EQ(model.ground_truth().contacts.falls, 1);
}

TEST(RobotModel, TheSideOfARampIsAnObstacle) {
  World world;
  // The ramp is beside the start, and 10 cm high where the robot hits it.
  world.objects.push_back({Ramp{{-2.0, 1.0, 0.0}, {2.0, 1.0, 0.2}, 1.0}});
  world.T_world_start.yaw = 0.5 * geometry::kPi;
  RobotModel model(world, exact_params(), 1);
  model.set_wheel_speeds({0.5, 0.5});
  model.advance_to(at(4s));
  EXPECT_EQ(model.ground_truth().contacts.collisions, 1);
  EXPECT_EQ(model.ground_truth().contacts.falls, 0);
  EXPECT_LT(model.ground_truth().T_world_base.translation().y(), 0.5);
}

// s = v^2 / (2 (mu cos +- sin) g) along the slope.
TEST(RobotModel, BrakingTakesLongerDownhill) {
  const double slope_rad = deg_to_rad(12.0);
  for (const double direction : {1.0, -1.0}) {
    World world;
    world.objects.push_back(
        {Ramp{{-20.0, 0.0, 0.0}, {20.0, 0.0, 40.0 * std::tan(slope_rad)}, 2.0}});
    world.start_height_m = 20.0 * std::tan(slope_rad);
    world.T_world_start.yaw = direction > 0.0 ? 0.0 : geometry::kPi;
    RobotModel model(world, exact_params(), 1);
    model.set_wheel_speeds({1.0, 1.0});
    model.advance_to(at(3s));
    const Eigen::Vector3d before = model.ground_truth().T_world_base.translation();
    const double speed_mps = model.ground_truth().forward_mps;
    model.brake_wheels();
    model.advance_to(at(5s));
    const double mps2 = 9.81 * (0.6 * std::cos(slope_rad) + direction * std::sin(slope_rad));
    EXPECT_NEAR((model.ground_truth().T_world_base.translation() - before).norm(),
                speed_mps * speed_mps / (2.0 * mps2), 1e-3);  // a step at 1 m/s
  }
}

TEST(RobotModel, GlassGivesNoEcho) {
  World world = wall_ahead(3.0);
  world.objects.push_back({Box{{2.0, 0.0, 1.0}, {0.02, 0.5, 2.0}, 0.0}, 0.0});
  RobotModel model(world, exact_params(), 1);
  model.advance_to(at(100ms));
  EXPECT_EQ(model.measure(0.0, at(100ms)).kind, Echo::Kind::kNothing);
  // Beyond the glass's edge, at 0.25 / 1.84 = 8 degrees, the wall is measured.
  EXPECT_EQ(model.measure(deg_to_rad(10.0), at(100ms)).kind, Echo::Kind::kRange);
  model.set_wheel_speeds({0.5, 0.5});
  model.advance_to(at(6s));
  EXPECT_EQ(model.ground_truth().contacts.collisions, 1);
}

// A range finder measures by reflected light, so it sees the wall through the pane behind the
// robot.
TEST(RobotModel, RangeFindersLookThroughGlass) {
  World world;
  world.objects.push_back({Box{{-0.225 - 0.2 - 0.01, 0.0, 1.0}, {0.02, 2.0, 2.0}, 0.0}, 0.0});
  RobotModel model(world, exact_params(), 1);
  const Eigen::Vector3d back(-0.225, 0.0, 0.12);
  EXPECT_FALSE(model.distance_from(back, geometry::kPi, 0.8));
  world.objects.push_back({Box{{-0.225 - 0.5 - 0.05, 0.0, 1.0}, {0.1, 2.0, 2.0}, 0.0}});
  RobotModel before_wall(world, exact_params(), 1);
  EXPECT_NEAR(before_wall.distance_from(back, geometry::kPi, 0.8).value(), 0.5, 1e-12);
  EXPECT_FALSE(before_wall.distance_from(back, geometry::kPi, 0.49));
}

// Over the edge of a pit the laser, at 0.38 m, measures the pit's far wall where the floor is
// missing.
TEST(RobotModel, MeasuresIntoAPit) {
  World world;
  world.pits.push_back({{1.0, -2.0}, {1.6, 2.0}, 1.0});
  RobotModel model(world, exact_params(), 1);
  model.set_pitch_goal({deg_to_rad(-20.0), 0.0, 0.0});
  model.advance_to(at(1s));
  // Without the pit the beam would hit the floor 1.04 m ahead of the axis, at x = 1.19 m. It hits
  // the pit's far wall at 1.6 - 0.15 = 1.45 m, below the floor by 1.45 tan 20 - 0.38 = 0.15 m. The
  // tolerance is 1.25 times the measured error of the mean over the spot.
  EXPECT_NEAR(model.measure(0.0, at(1s)).range_m, 1.45 / std::cos(deg_to_rad(20.0)), 1.4e-6);
}

TEST(RobotModel, TheBodyTiltsBackWhenItAcceleratesAndForwardWhenItBrakes) {
  RobotModelParams params = exact_params();
  params.drive.tilt_per_mps2_rad = deg_to_rad(0.1);
  RobotModel model({}, params, 1);
  model.set_wheel_speeds({2.0, 2.0});
  model.advance_to(at(200ms));
  EXPECT_GT(model.ground_truth().T_world_base.linear()(2, 0), 1e-3);  // the front points up
  model.brake_wheels();
  model.advance_to(at(400ms));
  EXPECT_LT(model.ground_truth().T_world_base.linear()(2, 0), -1e-3);
}

}  // namespace robot_model_test
}  // namespace nodmap::sim
