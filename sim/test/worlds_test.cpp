// SPDX-License-Identifier: BSD-3-Clause
// Checks that the robot has room in the simulator's own worlds and in random ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <filesystem>
#include <map>

#include "common/geometry/angle.hpp"
#include "sim/body/collision.hpp"
#include "sim/body/ground.hpp"
#include "sim/body/robot_model.hpp"
#include "sim/test/host.hpp"
#include "sim/world/random_world.hpp"
#include "sim/world/world_file.hpp"

namespace nodmap::sim {
namespace worlds_test {

constexpr double kCellM = 0.1;

// The places that the robot can reach from its start on the floor, ramps and platforms, with room
// to rotate everywhere.
class Reached {
 public:
  explicit Reached(const World& world)
      : collision_(world, square()), ground_(world, {}), start_(world.T_world_start) {
    std::deque<Cell> open{{0, 0}};
    heights_m_[{0, 0}] = world.start_height_m;
    while (!open.empty()) {
      const auto [x, y] = open.front();
      open.pop_front();
      const double height_m = heights_m_[{x, y}];
      for (const Cell& next : {Cell{x + 1, y}, Cell{x - 1, y}, Cell{x, y + 1}, Cell{x, y - 1}}) {
        if (heights_m_.size() < 200'000 && !heights_m_.contains(next) && has_room(next, height_m)) {
          heights_m_[next] = ground_.roll(place_of(next), height_m).height_m;
          open.push_back(next);
        }
      }
    }
  }

  [[nodiscard]] double area_m2() const {
    return static_cast<double>(heights_m_.size()) * kCellM * kCellM;
  }
  [[nodiscard]] bool holds(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d v = (p - start_.translation()) / kCellM;
    return heights_m_.contains(
        {static_cast<int>(std::lround(v.x())), static_cast<int>(std::lround(v.y()))});
  }

 private:
  using Cell = std::pair<int, int>;

  // At 0 and 45 degrees, its corners lie on the circle in which the robot rotates.
  static BodyParams square() {
    BodyParams params;
    params.length_m = params.width_m = std::hypot(0.45, 0.33) / std::sqrt(2.0);
    return params;
  }
  [[nodiscard]] Eigen::Vector2d place_of(const Cell& cell) const {
    return start_.translation() + kCellM * Eigen::Vector2d(cell.first, cell.second);
  }
  // `height_m`: of the ground beside the cell. The edge of a platform is not driven over.
  [[nodiscard]] bool has_room(const Cell& cell, double height_m) const {
    // Between the corners of both squares, the circle is this far from them.
    constexpr double kBetweenCornersM = 0.07;
    const Eigen::Vector2d p = place_of(cell);
    const double ground_m = ground_.roll(p, height_m).height_m;
    return std::abs(ground_m - height_m) <= kMaxRiseM &&
           std::ranges::all_of(std::array{0.0, 0.25 * geometry::kPi}, [&](double yaw_rad) {
             const BodyPose body{{p.x(), p.y(), yaw_rad}, ground_m, kMaxRiseM};
             return collision_.clearance_m(body) > kBetweenCornersM;
           });
  }

  // Of a ramp of 15 degrees, from one cell to the next.
  static constexpr double kMaxRiseM = 0.27 * kCellM;

  Collision collision_;
  Ground ground_;
  geometry::SE2 start_;
  std::map<Cell, double> heights_m_;  // of the ground
};

std::string file_of(const std::string& name) {
  return NODMAP_SOURCE_DIR "/sim/worlds/" + name + ".yaml";
}

TEST(Worlds, AllCanBeLoadedAndTheirStartsAreFree) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(NODMAP_SOURCE_DIR "/sim/worlds")) {
    if (entry.path().extension() != ".yaml") {
      continue;
    }
    ++count;
    const World world = load_world(entry.path());
    EXPECT_EQ(world.name, entry.path().stem());
    RobotModel model(world, {}, 1);
    model.advance_to(test::at(1ms));
    EXPECT_GT(model.ground_truth().clearance_m, 0.2) << world.name;
    const Reached reached(world);
    EXPECT_GT(reached.area_m2(), 5.0) << world.name;
    EXPECT_LT(reached.area_m2(), 1300.0) << world.name << " has a hole in its walls";
    for (const Eigen::Vector2d& goal : world.goals) {
      EXPECT_TRUE(reached.holds(goal)) << world.name << ' ' << goal.transpose();
    }
  }
  EXPECT_GE(count, 9);
}

TEST(Worlds, TheCorridorsOfTheCellarFormARing) {
  const Reached reached(load_world(file_of("cellar")));
  for (const Eigen::Vector2d& p :
       {Eigen::Vector2d(4.0, 0.0), {0.0, 2.4}, Eigen::Vector2d(-4.0, 0.0)}) {
    EXPECT_TRUE(reached.holds(p)) << p.transpose();
  }
}

TEST(Worlds, AllRoomsOfTheOfficeCanBeReached) {
  const Reached reached(load_world(file_of("office")));
  for (int room = 0; room < 5; ++room) {
    for (const double side : {-1.0, 1.0}) {
      EXPECT_TRUE(reached.holds({1.0 + 4.0 * room, side * 2.2})) << room << ' ' << side;
    }
  }
}

TEST(Worlds, TheRampBesideTheStairsLeadsToThePlatform) {
  World world = load_world(file_of("stairs"));
  world.T_world_start = {2.0, -2.8, 0.0};
  RobotModel model(world, {}, 1);
  model.set_wheel_speeds({0.5, 0.5});
  model.advance_to(test::at(11s));
  EXPECT_EQ(model.ground_truth().contacts.collisions, 0);
  EXPECT_NEAR(model.ground_truth().T_world_base.translation().z(), 0.4, 1e-9);
}

TEST(Worlds, ALevelLaserSeesNoneOfTheObstaclesOfFig5) {
  const World world = load_world(file_of("fig5"));
  const RobotModelParams params;
  for (const Object& object : world.objects) {
    const auto* box = std::get_if<Box>(&object.shape);
    if (box == nullptr) {
      continue;
    }
    const double bottom_m = box->center.z() - 0.5 * box->size.z();
    const double top_m = box->center.z() + 0.5 * box->size.z();
    const bool room = box->size.z() > 2.0 || bottom_m > 2.0;
    EXPECT_TRUE(room || top_m < params.servo.mount_z_m - 0.05 ||
                bottom_m > params.servo.mount_z_m + 0.01);
    EXPECT_TRUE(room || bottom_m < params.body.height_m);
  }
}

int obstacles_of(const World& world) {
  int boxes = 0;
  int cylinders = 0;
  int plates = 0;
  for (const Object& object : world.objects) {
    const auto* box = std::get_if<Box>(&object.shape);
    boxes += box != nullptr ? 1 : 0;
    cylinders += box == nullptr ? 1 : 0;
    plates += box != nullptr && box->center.z() - 0.5 * box->size.z() > 0.01 ? 1 : 0;
  }
  return boxes - 4 + cylinders - 4 * plates;  // without the four walls; a plate has four legs
}

TEST(RandomWorld, HasTheStatedNumberOfObstaclesAndRoomBetweenThem) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const World world = random_clutter(seed);
    EXPECT_GE(obstacles_of(world), 25) << seed;
    EXPECT_LE(obstacles_of(world), 40) << seed;
    RobotModel model(world, {}, 1);
    model.advance_to(test::at(1ms));
    EXPECT_GT(model.ground_truth().clearance_m, 0.6 - 0.28) << seed;
    if (seed < 10) {
      // Of 100 m^2, this leaves out the obstacles and a border of half the robot's width around
      // each.
      EXPECT_GT(Reached(world).area_m2(), 30.0) << seed;
    }
  }
}

TEST(RandomWorld, TheSameSeedGivesTheSameWorld) {
  const auto numbers = [](std::uint64_t seed) {
    std::vector<double> all;
    for (const Object& object : random_clutter(seed).objects) {
      if (const auto* box = std::get_if<Box>(&object.shape)) {
        all.insert(all.end(), {box->center.x(), box->center.y(), box->size.z(), box->yaw_rad});
      }
    }
    return all;
  };
  EXPECT_EQ(numbers(4), numbers(4));
  EXPECT_NE(numbers(4), numbers(5));
}

}  // namespace worlds_test
}  // namespace nodmap::sim
