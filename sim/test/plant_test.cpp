// SPDX-License-Identifier: BSD-3-Clause
#include "sim/plant.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace nodmap::sim {
namespace {

using geometry::deg_to_rad;

constexpr std::int64_t kSecond = 1'000'000;

/// A robot without noise or slip, in a world of its own.
PlantParams exact_params() {
  PlantParams params;
  params.slip_distance_m = 0.0;
  params.slip_heading_rad = 0.0;
  params.slip_turn_rad = 0.0;
  params.range_sigma_m = 0.0;
  params.tilt_per_mps2_rad = 0.0;
  return params;
}

World wall_ahead(double x_m) {
  World world;
  world.objects.push_back({Box{{x_m + 0.05, 0.0, 1.0}, {0.1, 10.0, 2.0}, 0.0}});
  return world;
}

Actor walker(std::vector<Waypoint> path) {
  Actor actor;
  actor.path = std::move(path);
  return actor;
}

/// The numbers of a drive with the laser running.
std::vector<double> drive(std::uint64_t seed) {
  Plant plant(wall_ahead(8.0), {}, seed);
  plant.set_wheel_speeds({0.8, 1.0});
  plant.set_pitch_goal({0.2, 1.0, 20.0});
  std::vector<double> numbers;
  for (std::int64_t t = 0; t < 2 * kSecond; t += 13'320) {
    plant.advance_to(t);
    for (int beam = -90; beam <= 90; beam += 30) {
      numbers.push_back(plant.measure(deg_to_rad(beam), t - 5'000).range_m);
    }
    const Truth truth = plant.truth();
    numbers.push_back(truth.T_world_base.translation().x());
    numbers.push_back(truth.T_world_base.translation().y());
    numbers.push_back(truth.pitch_rad);
  }
  return numbers;
}

TEST(Plant, SameSeedSameNumbersOtherSeedOthers) {
  EXPECT_EQ(drive(7), drive(7));
  EXPECT_NE(drive(7), drive(8));
}

TEST(Plant, StandingRobotStaysAndCountsNothing) {
  Plant plant(wall_ahead(2.0), {}, 1);
  plant.advance_to(10 * kSecond);
  EXPECT_EQ(plant.wheel_travel().left_m, 0.0);
  EXPECT_EQ(plant.wheel_travel().right_m, 0.0);
  EXPECT_TRUE(plant.truth().T_world_base.isApprox(geometry::SE3::Identity()));
  EXPECT_EQ(plant.truth().collisions, 0);
}

TEST(Plant, MeasuresFromThePitchAxis) {
  Plant plant(wall_ahead(3.0), exact_params(), 1);
  plant.advance_to(100'000);
  // 2.85 m from the axis; the spot's rim is further by 2.85 * (0.25 / 2 degrees)^2 / 2 = 7 um.
  EXPECT_NEAR(plant.measure(0.0, 100'000).range_m, 2.85, 1e-4);
  EXPECT_NEAR(plant.measure(deg_to_rad(60.0), 100'000).range_m, 5.7, 1e-3);
  plant.set_pitch_goal({deg_to_rad(-20.0), 0.0, 0.0});
  plant.advance_to(kSecond);
  // The floor; the range is the mean over a spot that lies flat.
  EXPECT_NEAR(plant.measure(0.0, kSecond).range_m, 0.38 / std::sin(deg_to_rad(20.0)), 1e-3);
}

TEST(Plant, MeasuresThePast) {
  Plant plant(wall_ahead(10.0), exact_params(), 1);
  plant.set_wheel_speeds({1.0, 1.0});
  plant.advance_to(3 * kSecond);
  const double now_m = plant.measure(0.0, 3 * kSecond).range_m;
  // 1 m/s, long after the motors' lag.
  EXPECT_NEAR(plant.measure(0.0, 3 * kSecond - 100'000).range_m, now_m + 0.1, 1e-4);
  EXPECT_NEAR(plant.measure(0.0, 3 * kSecond - 12'345).range_m, now_m + 0.012345, 1e-4);
  EXPECT_THROW(static_cast<void>(plant.measure(0.0, 3 * kSecond + 1)), std::out_of_range);
  EXPECT_THROW(static_cast<void>(plant.measure(0.0, 2 * kSecond)), std::out_of_range);
  EXPECT_THROW(plant.advance_to(kSecond), std::invalid_argument);
}

TEST(Plant, SeesActorsWhereTheyWere) {
  World world;
  world.actors.push_back(walker({{0.0, {4.0, -2.0}}, {4.0, {4.0, 2.0}}}));
  Plant plant(world, exact_params(), 1);
  plant.advance_to(2 * kSecond);
  EXPECT_NEAR(plant.measure(0.0, 2 * kSecond).range_m, 4.0 - 0.25 - 0.15, 1e-3);
  plant.advance_to(2 * kSecond + 500'000);
  EXPECT_EQ(plant.measure(0.0, 2 * kSecond + 500'000).kind, Echo::Kind::kNothing);
}

TEST(Plant, WallStopsTheRobotAndCountsOnce) {
  PlantParams params = exact_params();
  params.tilt_per_mps2_rad = deg_to_rad(0.1);
  Plant plant(wall_ahead(1.0), params, 1);
  plant.set_wheel_speeds({0.5, 0.5});
  plant.advance_to(5 * kSecond);
  const Truth truth = plant.truth();
  EXPECT_EQ(truth.collisions, 1);
  // A step at 0.5 m/s is half a millimetre.
  EXPECT_NEAR(truth.T_world_base.translation().x(), 1.0 - 0.225, 6e-4);
  EXPECT_NEAR(truth.clearance_m, 0.0, 6e-4);
  EXPECT_EQ(truth.forward_mps, 0.0);
  EXPECT_GT(plant.wheel_travel().left_m, 2.0);                // the wheels slip
  EXPECT_NEAR(truth.T_world_base.linear()(2, 2), 1.0, 1e-6);  // and the body stands level

  plant.set_wheel_speeds({-0.5, -0.5});
  plant.advance_to(7 * kSecond);
  EXPECT_GT(plant.truth().clearance_m, 0.5);
  plant.set_wheel_speeds({0.5, 0.5});
  plant.advance_to(12 * kSecond);
  EXPECT_EQ(plant.truth().collisions, 2);
}

TEST(Plant, ActorWhoWalksIntoTheStandingRobotBumps) {
  World world;
  world.actors.push_back(walker({{1.0, {2.0, 0.0}}, {4.0, {0.3, 0.0}}, {7.0, {2.0, 0.0}}}));
  Plant standing(world, exact_params(), 1);
  standing.advance_to(8 * kSecond);
  EXPECT_EQ(standing.truth().bumps, 1);
  EXPECT_EQ(standing.truth().collisions, 0);

  Plant driving(world, exact_params(), 1);
  driving.set_wheel_speeds({0.1, 0.1});
  driving.advance_to(5 * kSecond);
  EXPECT_EQ(driving.truth().bumps, 0);
  EXPECT_EQ(driving.truth().collisions, 1);
}

TEST(Plant, ActorsAppearAndVanish) {
  World world;
  Actor actor = walker({{0.0, {2.0, 0.0}}});
  actor.appear_s = 1.0;
  actor.vanish_s = 2.0;
  world.actors.push_back(actor);
  Plant plant(world, exact_params(), 1);
  plant.advance_to(kSecond - 10'000);
  EXPECT_TRUE(plant.truth().actors.empty());
  plant.advance_to(kSecond + 10'000);
  ASSERT_EQ(plant.truth().actors.size(), 1U);
  EXPECT_NEAR(plant.truth().clearance_m, 2.0 - 0.225 - 0.25, 1e-12);
  plant.advance_to(2 * kSecond + 10'000);
  EXPECT_TRUE(plant.truth().actors.empty());
}

TEST(Plant, PitStopsTheRobotAsACollision) {
  World world;
  world.pits.push_back({{1.0, -1.0}, {3.0, 1.0}, 0.5});
  Plant plant(world, exact_params(), 1);
  plant.set_wheel_speeds({0.5, 0.5});
  plant.advance_to(5 * kSecond);
  EXPECT_EQ(plant.truth().collisions, 1);
  EXPECT_NEAR(plant.truth().T_world_base.translation().x(), 1.0 - 0.225, 6e-4);
}

TEST(Plant, FollowsARampAndDoesNotFallOffItsEnd) {
  World world;
  world.objects.push_back({Ramp{{1.0, 0.0, 0.0}, {4.0, 0.0, 0.5}, 2.0}});
  Plant plant(world, exact_params(), 1);
  plant.set_wheel_speeds({1.0, 1.0});
  plant.advance_to(2'500'000);
  const Truth truth = plant.truth();
  EXPECT_EQ(truth.collisions, 0);
  const Eigen::Vector3d p = truth.T_world_base.translation();
  // On the slope, and tilted with it. Chord and ramp differ only at its foot.
  EXPECT_NEAR(p.z(), (p.x() - 1.0) / 6.0, 1e-6);
  EXPECT_NEAR(truth.T_world_base.linear()(2, 0), 0.5 / std::hypot(3.0, 0.5), 1e-6);
  plant.advance_to(10 * kSecond);
  EXPECT_EQ(plant.truth().collisions, 1);
  EXPECT_NEAR(plant.truth().T_world_base.translation().x(), 4.0, 2e-3);
}

TEST(Plant, NodsBackWhenItGainsSpeed) {
  PlantParams params = exact_params();
  params.tilt_per_mps2_rad = deg_to_rad(0.1);
  Plant plant({}, params, 1);
  plant.set_wheel_speeds({2.0, 2.0});
  plant.advance_to(200'000);
  EXPECT_GT(plant.truth().T_world_base.linear()(2, 0), 1e-3);  // the front points up
  plant.brake_wheels();
  plant.advance_to(400'000);
  EXPECT_LT(plant.truth().T_world_base.linear()(2, 0), -1e-3);
}

}  // namespace
}  // namespace nodmap::sim
