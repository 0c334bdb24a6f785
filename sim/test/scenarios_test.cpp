// SPDX-License-Identifier: BSD-3-Clause
// Checks that the generated worlds and those of the BARN challenge have their stated properties.
#include "sim/world/scenarios/scenarios.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "common/formats/user_error.hpp"
#include "sim/body/robot_model.hpp"
#include "sim/body/shortest_path.hpp"
#include "sim/test/host.hpp"
#include "sim/world/barn_file.hpp"
#include "sim/world/pedestrian_file.hpp"
#include "sim/world/ray_caster.hpp"
#include "sim/world/scenarios/builder.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::sim {
namespace scenarios_test {

// A square body as wide as the circle in which KURT3D rotates.
BodyParams turning_circle() {
  BodyParams body;
  body.length_m = body.width_m = std::hypot(body.length_m, body.width_m);
  return body;
}

Eigen::Vector2d nearest_point(const Pit& pit, const Eigen::Vector2d& p) {
  return p.cwiseMax(pit.min).cwiseMin(pit.max);
}

// The world with the robot heading for the nearest hole.
World looking_at_hole(World world) {
  const Eigen::Vector2d start = world.T_world_start.translation();
  Eigen::Vector2d nearest = nearest_point(world.pits.front(), start);
  for (const Pit& pit : world.pits) {
    const Eigen::Vector2d p = nearest_point(pit, start);
    nearest = (p - start).norm() < (nearest - start).norm() ? p : nearest;
  }
  world.T_world_start.yaw = std::atan2(nearest.y() - start.y(), nearest.x() - start.x());
  return world;
}

class Holes : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(Holes, ARobotThatDrivesStraightOnFallsIn) {
  RobotModel model(looking_at_hole(make_holes(GetParam())), {}, 1);
  model.set_wheel_speeds({0.5, 0.5});
  model.advance_to(test::at(10s));
  EXPECT_EQ(model.ground_truth().contacts.falls, 1);
  EXPECT_EQ(model.ground_truth().contacts.collisions, 1);
}

TEST_P(Holes, TheGoalCanBeReachedAroundThem) {
  const World world = make_holes(GetParam());
  const auto length_m = shortest_path_m(world, turning_circle());
  ASSERT_TRUE(length_m);
  const double straight_m = (world.goals.back() - world.T_world_start.translation()).norm();
  EXPECT_GE(*length_m, straight_m - 0.05);  // cells of 5 cm
  EXPECT_LE(*length_m, 2.0 * straight_m);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Holes, ::testing::Range<std::uint64_t>(0, 24));

class Ramps : public ::testing::TestWithParam<std::uint64_t> {};

// Driving straight over the ramp causes no contact, and the robot's pitch is that of the ramp.
TEST_P(Ramps, ARobotThatDrivesStraightOverThemArrives) {
  const World world = make_ramps(GetParam());
  RobotModelParams params;
  params.drive.slip_heading_rad = params.drive.slip_turning_rad = 0.0;
  params.drive.ground_tilt_rad = params.drive.tilt_per_mps2_rad = 0.0;
  RobotModel model(world, params, 1);
  model.set_wheel_speeds({0.5, 0.5});
  double steepest = 0.0;
  const auto to_goal_m = [&] {
    return (model.ground_truth().T_world_base.translation().head<2>() - world.goals.back()).norm();
  };
  for (time::SteadyTime now{}; now < test::at(40s) && to_goal_m() > 0.1; now += 10ms) {
    model.advance_to(now);
    steepest = std::max(steepest, std::abs(model.ground_truth().T_world_base.linear()(2, 0)));
  }
  EXPECT_LE(to_goal_m(), 0.1);
  EXPECT_EQ(model.ground_truth().contacts.collisions, 0);
  constexpr double kSlopesDeg[] = {5.0, 10.0, 12.0};
  EXPECT_NEAR(steepest, std::sin(geometry::deg_to_rad(kSlopesDeg[GetParam() % 3])), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Ramps, ::testing::Range<std::uint64_t>(0, 18));

class Scenarios : public ::testing::TestWithParam<Scenario> {};

TEST_P(Scenarios, TheStartIsFreeAndTheGoalsCanBeReached) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const World world = GetParam().make(seed);
    RobotModel model(world, {}, 1);
    model.advance_to(test::at(10ms));
    EXPECT_EQ(model.ground_truth().contacts.collisions, 0) << seed;
    EXPECT_GT(model.ground_truth().clearance_m, 0.0) << seed;
    BodyParams body;
    body.width_m = 0.45;
    // The slot is narrower than the wider body.
    EXPECT_EQ(shortest_path_m(world, world.name == "slot" ? BodyParams{} : body).has_value(),
              !world.goals.empty())
        << seed;
  }
}

TEST_P(Scenarios, TheSameSeedGivesTheSameWorldAndAnotherSeedAnotherWorld) {
  const auto numbers = [](const World& world) {
    std::vector<double> all{world.T_world_start.yaw};
    for (const Object& object : world.objects) {
      const Bounds bounds = bounds_of(object);
      all.insert(all.end(), bounds.min.begin(), bounds.min.end());
      all.insert(all.end(), bounds.max.begin(), bounds.max.end());
    }
    for (const Actor& actor : world.actors) {
      all.push_back(actor.position(1.0).x());
    }
    return all;
  };
  EXPECT_EQ(numbers(GetParam().make(3)), numbers(GetParam().make(3)));
  EXPECT_NE(numbers(GetParam().make(3)), numbers(GetParam().make(4)));
}

INSTANTIATE_TEST_SUITE_P(All, Scenarios,
                         ::testing::ValuesIn(scenarios().begin(), scenarios().end()),
                         [](const auto& scenario) {
                           std::string name(scenario.param.name);
                           std::erase(name, '-');
                           return name;
                         });

// Around a disc of radius R the shortest path is two tangents and an arc of radius r = R + half the
// body's width.
TEST(ShortestPath, AroundADiscItIsTwoTangentsAndAnArc) {
  World world;
  world.objects.push_back({Cylinder{{2.0, 0.0, 0.5}, 0.8, 1.0}});
  world.goals.emplace_back(4.0, 0.0);
  const BodyParams body;
  const double r = 0.8 + 0.5 * body.width_m;
  const double expected_m =
      2.0 * std::sqrt(4.0 - r * r) + r * (geometry::kPi - 2.0 * std::acos(r / 2.0));
  // One and a half cells on each side.
  EXPECT_NEAR(shortest_path_m(world, body).value(), expected_m, 0.1);
  EXPECT_GE(shortest_path_m(world, body).value(), expected_m - 0.02);
}

TEST(ShortestPath, OverSeveralGoalsItIsTheSumAndBehindAWallThereIsNone) {
  World world;
  world.goals = {{3.0, 0.0}, {3.0, 4.0}, {0.0, 0.0}};
  EXPECT_NEAR(shortest_path_m(world, {}).value(), 12.0, 1e-9);  // rounding
  Builder closed("closed", 1);
  closed.walls_around({-1.0, -1.0}, {1.0, 1.0});
  closed.goal(3.0, 0.0);
  EXPECT_FALSE(shortest_path_m(closed.world(), {}));
  EXPECT_FALSE(shortest_path_m({}, {}));
}

TEST(ShortestPath, IsNotSearchedForWhereTheGridWouldBeTooLarge) {
  World world;
  for (const double far_m : {1e5, 1e9, 1e300}) {
    world.goals = {{far_m, far_m}};
    EXPECT_FALSE(shortest_path_m(world, {})) << far_m;
  }
}

TEST(Builder, AMirroredWorldMirrorsAllItsParts) {
  Builder builder("mirrored", 1);
  builder.start(1.0, 2.0, 0.3);
  builder.goal(4.0, 1.0);
  builder.box({1.0, 1.0}, {0.4, 0.2}, {0.0, 1.0}, 0.5);
  builder.pit({2.0, 1.0}, {3.0, 1.5}, 0.2);
  builder.ramp({0.0, 1.0, 0.0}, {1.0, 2.0, 0.1}, 1.0);
  const World world = mirrored(builder.world());
  EXPECT_EQ(world.T_world_start.y, -2.0);
  EXPECT_EQ(world.T_world_start.yaw, -0.3);
  EXPECT_EQ(world.goals.front(), Eigen::Vector2d(4.0, -1.0));
  EXPECT_EQ(std::get<Box>(world.objects[0].shape).yaw_rad, -0.5);
  EXPECT_EQ(world.pits.front().min, Eigen::Vector2d(2.0, -1.5));
  EXPECT_EQ(world.pits.front().max, Eigen::Vector2d(3.0, -1.0));
  EXPECT_EQ(std::get<Ramp>(world.objects[1].shape).to, Eigen::Vector3d(1.0, -2.0, 0.1));
}

class BarnFile : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    const auto file = dir_.path() / "worlds.txt";
    std::ofstream(file) << text;
    return file;
  }
  nodmap::test::TemporaryDir dir_;
};

TEST_F(BarnFile, ReadsCylindersAndRules) {
  const auto file = write("# worlds\nW 2 1\n0 0\nW 3 2\n-0.5 1.25\n0.25 2\n");
  std::ofstream(dir_.path() / "optimal.txt") << "# index length\n3 12.5 6.25 2 0.2\n";
  const World world = load_barn_world(file, 3);
  ASSERT_EQ(world.objects.size(), 2U);
  const auto& cylinder = std::get<Cylinder>(world.objects[0].shape);
  EXPECT_EQ(cylinder.center, Eigen::Vector3d(-0.5, 1.25, 0.25));
  EXPECT_EQ(cylinder.radius_m, 0.075);
  EXPECT_EQ(cylinder.height_m, 0.5);
  EXPECT_EQ(world.T_world_start.x, -2.25);
  EXPECT_EQ(world.goals.front(), Eigen::Vector2d(-2.25, 13.0));
  EXPECT_EQ(world.task.reference_path_m, 12.5);
  EXPECT_EQ(world.task.arrival_radius_m, 1.0);
  EXPECT_TRUE(world.task.ends_at_contact);
}

// A Catmull-Rom spline passes through its key frames, and has constant speed if they are evenly
// spaced on a line.
TEST_F(BarnFile, MovingCylindersFollowASpline) {
  const World world =
      load_barn_world(write("W 300 1\nC 0.5 4 5 name\n0 0 0\n1 1 2\n2 2 4\n3 3 6\n4 3 0\n"), 300);
  ASSERT_EQ(world.actors.size(), 1U);
  const Actor& actor = world.actors.front();
  EXPECT_EQ(actor.radius_m, 0.5);
  EXPECT_TRUE(actor.position(3.0).isApprox(Eigen::Vector2d(3.0, 6.0)));
  EXPECT_TRUE(actor.position(1.5).isApprox(Eigen::Vector2d(1.5, 3.0)));
  EXPECT_TRUE(actor.position(5.0).isApprox(actor.position(1.0)));
  EXPECT_EQ(world.T_world_start.x, 11.0);
}

TEST_F(BarnFile, RefusesInvalidFiles) {
  for (const char* text :
       {"", "W 1 2\n0 0\n", "W 1 1\n0\n", "W 1 -1\n", "V 1 1\n0 0\n", "W 1 1\nnan 0\n",
        "W 1 1\nC 0.5 4 2 name\n1 0 0\n1 0 0\n", "W 1 99999999\n",
        // Two actors whose sampled paths together would take a gigabyte for 20 times as many.
        "W 1 2\nC 0.5 4 2 a\n0 0 0\n30000 0 0\nC 0.5 4 2 b\n0 0 0\n30000 0 0\n"}) {
    EXPECT_THROW(static_cast<void>(load_barn_world(write(text), 1)), formats::UserError) << text;
  }
  EXPECT_THROW(static_cast<void>(load_barn_world(dir_.path() / "none", 1)), formats::UserError);
}

// The challenge's own worlds. The lengths are those of data/barn/bottleneck.txt: they are for a
// half width of 0.215 m, and for a grid of 2.5 cm, on which paths in eight directions are up to 8 %
// longer.
TEST_F(BarnFile, ShortestPathsAreThoseOfTheChallenge) {
  NODMAP_REQUIRE_DATA(file, "barn/worlds.txt");
  const World first = load_barn_world(file, 2);
  EXPECT_EQ(first.objects.size(), 234U);
  EXPECT_EQ(std::get<Cylinder>(first.objects[0].shape).center.x(), -0.075);
  BodyParams jackal;
  jackal.width_m = 0.43;
  for (const auto& [index, length_m] : std::initializer_list<std::pair<int, double>>{
           {2, 10.0}, {5, 10.0}, {146, 10.81}, {299, 10.7}}) {
    const auto found_m = shortest_path_m(load_barn_world(file, index), jackal);
    ASSERT_TRUE(found_m) << index;
    EXPECT_GE(*found_m, 0.92 * length_m) << index;
    EXPECT_LE(*found_m, length_m + 0.1) << index;  // two cells
  }
}

TEST_F(BarnFile, PedestriansFollowTheirRecording) {
  const auto file = write("0 7 0 0\n10 7 1 2\n5 9 4 4\n15 9 6 4\n");
  const World world = load_pedestrians(file, 2.5, 1);
  ASSERT_EQ(world.actors.size(), 2U);
  const Actor& first = world.actors[0];
  EXPECT_EQ(first.vanish_s - first.appear_s, 4.0);
  const Eigen::Vector2d middle = first.position(first.appear_s + 2.0);
  EXPECT_EQ(middle.x(), 0.5);
  EXPECT_EQ(std::abs(middle.y()), 1.0);  // every other world is mirrored
  EXPECT_EQ(world.goals.size(), 1U);
  EXPECT_FALSE(first.reacts);
  for (const char* text : {"", "0 1 2\n", "0 1 0 0\n0 1 0 0\n", "0 1 nan 0\n"}) {
    EXPECT_THROW(static_cast<void>(load_pedestrians(write(text), 2.5, 1)), formats::UserError)
        << text;
  }
}

}  // namespace scenarios_test
}  // namespace nodmap::sim
