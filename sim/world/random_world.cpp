// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/random_world.hpp"

#include <algorithm>
#include <array>
#include <random>
#include <stdexcept>
#include <string>

#include "common/geometry/angle.hpp"

namespace nodmap::sim {
namespace {

constexpr double kHalfRoomM = 5.0;
constexpr double kStartFreeM = 0.6;
// The robot can rotate wherever it gets, because its diagonal is 0.56 m;
constexpr double kWidePassageM = 0.6;
// here it can just pass, with 8 cm on each side.
constexpr double kNarrowPassageM = 0.5;
// Free radius around a goal, in which the robot can rotate.
constexpr double kGoalFreeM = 0.4;
// Greatest number of tries to find a place; if there is one, a few hundred suffice.
constexpr int kMaxTries = 100'000;
constexpr double kLegRadiusM = 0.015;
// Just higher than the robot can drive over (BodyParams::climb_height_m).
constexpr double kMinHeightM = 0.031;

// An obstacle before it is placed: objects around the origin, with an enclosing circle.
struct Obstacle {
  std::vector<Object> objects;
  double radius_m = 0.0;
};

// How densely a room is filled.
struct Clutter {
  const char* name;
  double passage_m;
  int least;
  int most;
};

class Maker {
 public:
  Maker(const Clutter& clutter, std::uint64_t seed) : clutter_(clutter), engine_(seed) {}

  World make();
  // Makes a world with a random start and a goal far from it.
  World make_with_goal();
  // Makes a world whose goal has a heading, with a box of 30 cm in front of it.
  World make_with_dock();

 private:
  double between(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(engine_);
  }
  int count(int least, int most) {
    return std::uniform_int_distribution<int>(least, most)(engine_);
  }

  Obstacle make_obstacle();
  Obstacle make_box(double height_m);
  Obstacle make_small_box();
  static Obstacle make_plate(double bottom_m, double size_m, double leg_inset_m);
  Obstacle make_pole();
  void fill(World& world);
  bool place(const Obstacle& obstacle, World& world);
  [[nodiscard]] Eigen::Vector2d free_place(double free_m);
  [[nodiscard]] bool is_free(const Eigen::Vector2d& p, double free_m) const;
  [[noreturn]] void fail(const std::string& what) const;

  struct Circle {
    Eigen::Vector2d center;
    double radius_m;
  };
  Clutter clutter_;
  std::mt19937_64 engine_;
  std::vector<Circle> taken_;
};

World walled_room(const char* name) {
  World world;
  world.name = name;
  constexpr double kThicknessM = 0.1;
  constexpr double kWallM = kHalfRoomM + 0.5 * kThicknessM;
  constexpr double kLengthM = 2.0 * kHalfRoomM + 2.0 * kThicknessM;
  for (const double side : {-1.0, 1.0}) {
    world.objects.push_back({Box{{side * kWallM, 0.0, 1.25}, {kThicknessM, kLengthM, 2.5}, 0.0}});
    world.objects.push_back({Box{{0.0, side * kWallM, 1.25}, {kLengthM, kThicknessM, 2.5}, 0.0}});
  }
  return world;
}

World Maker::make() {
  World world = walled_room(clutter_.name);
  world.T_world_start.yaw = between(-geometry::kPi, geometry::kPi);
  fill(world);
  return world;
}

World Maker::make_with_goal() {
  constexpr double kFarM = 6.0;
  World world = make();
  for (int i = 0; i < kMaxTries; ++i) {
    const Eigen::Vector2d start = free_place(kGoalFreeM);
    const Eigen::Vector2d goal = free_place(kGoalFreeM);
    if ((start - goal).norm() >= kFarM) {
      world.T_world_start.x = start.x();
      world.T_world_start.y = start.y();
      world.goals.push_back(goal);
      return world;
    }
  }
  fail("has no two free places that are far from each other");
}

World Maker::make_with_dock() {
  constexpr double kRunUpM = 0.8;
  const Eigen::Vector3d station_size(0.2, 0.4, 0.3);
  // 12 cm ahead of the body, so that its corners pass when it rotates.
  constexpr double kToStationM = 0.35;
  World world = make_with_goal();
  for (int i = 0; i < kMaxTries; ++i) {
    const Eigen::Vector2d goal = free_place(kGoalFreeM);
    const double heading_rad = between(-geometry::kPi, geometry::kPi);
    const Eigen::Vector2d ahead(std::cos(heading_rad), std::sin(heading_rad));
    const double run_up_m = kRunUpM + kGoalFreeM;
    if (is_free(goal - 0.5 * kRunUpM * ahead, kGoalFreeM) &&
        is_free(goal - kRunUpM * ahead, kGoalFreeM) &&
        (goal - world.T_world_start.translation()).norm() > run_up_m + kStartFreeM) {
      const Eigen::Vector2d station = goal + (kToStationM + 0.5 * station_size.x()) * ahead;
      world.objects.push_back(
          {Box{{station.x(), station.y(), 0.5 * station_size.z()}, station_size, heading_rad}});
      world.goals = {goal};
      world.goal_heading_rad = heading_rad;
      return world;
    }
  }
  fail("has no place for a dock");
}

bool Maker::is_free(const Eigen::Vector2d& p, double free_m) const {
  return p.cwiseAbs().maxCoeff() <= kHalfRoomM - free_m &&
         std::ranges::all_of(taken_, [&](const Circle& other) {
           return (p - other.center).norm() >= other.radius_m + free_m;
         });
}

// A random free place. All free space is connected by passages between the bounding circles.
Eigen::Vector2d Maker::free_place(double free_m) {
  const double reach_m = kHalfRoomM - free_m;
  for (int i = 0; i < kMaxTries; ++i) {
    Eigen::Vector2d p(between(-reach_m, reach_m), between(-reach_m, reach_m));
    if (is_free(p, free_m)) {
      return p;
    }
  }
  fail("has no free place");
}

void Maker::fail(const std::string& what) const {
  throw std::runtime_error(std::string("world ") + clutter_.name + ": the room of this seed " +
                           what + "; take another seed");
}

void Maker::fill(World& world) {
  const int wanted = count(clutter_.least, clutter_.most);
  // Small ones still fit where there is no room for a table, so tries are cheap and many.
  constexpr int kTries = 20'000;
  int placed = 0;
  for (int i = 0; i < kTries && placed < wanted; ++i) {
    placed += place(make_obstacle(), world) ? 1 : 0;
  }
}

Obstacle Maker::make_obstacle() {
  switch (count(0, 6)) {
    case 0:
      return make_box(between(kMinHeightM, 0.10));
    case 6:  // a brick, a shoe, a tool
      return make_small_box();
    case 1:
      return make_box(between(0.15, 1.2));
    case 2:  // a table that the robot fits under
      return make_plate(0.70, between(0.7, 1.0), 0.05);
    case 3:  // a board that it does not fit under, legs far behind its edge
      return make_plate(between(0.30, 0.45), between(0.4, 0.8), 0.15);
    case 4:  // a chair
      return make_plate(0.44, between(0.38, 0.45), 0.02);
    default:
      return make_pole();
  }
}

Obstacle Maker::make_box(double height_m) {
  const double length_m = between(0.15, 0.6);
  const double width_m = between(0.15, 0.4);
  return {{{Box{{0.0, 0.0, 0.5 * height_m}, {length_m, width_m, height_m}, 0.0}}},
          0.5 * Eigen::Vector2d(length_m, width_m).norm()};
}

Obstacle Maker::make_small_box() {
  const double length_m = between(0.03, 0.2);
  const double width_m = between(0.03, 0.1);
  const double height_m = between(kMinHeightM, 0.15);
  return {{{Box{{0.0, 0.0, 0.5 * height_m}, {length_m, width_m, height_m}, 0.0}}},
          0.5 * Eigen::Vector2d(length_m, width_m).norm()};
}

// A square plate on four legs.
Obstacle Maker::make_plate(double bottom_m, double size_m, double leg_inset_m) {
  constexpr double kPlateM = 0.03;
  Obstacle obstacle;
  obstacle.radius_m = 0.5 * Eigen::Vector2d(size_m, size_m).norm();
  obstacle.objects.push_back(
      {Box{{0.0, 0.0, bottom_m + 0.5 * kPlateM}, {size_m, size_m, kPlateM}, 0.0}});
  const double leg_m = 0.5 * size_m - leg_inset_m;
  for (const double x : {-leg_m, leg_m}) {
    for (const double y : {-leg_m, leg_m}) {
      obstacle.objects.push_back({Cylinder{{x, y, 0.5 * bottom_m}, kLegRadiusM, bottom_m}});
    }
  }
  return obstacle;
}

Obstacle Maker::make_pole() {
  const double radius_m = count(0, 1) == 0 ? kLegRadiusM : between(0.03, 0.2);
  const double height_m = between(0.4, 2.0);
  return {{{Cylinder{{0.0, 0.0, 0.5 * height_m}, radius_m, height_m}}}, radius_m};
}

bool Maker::place(const Obstacle& obstacle, World& world) {
  const double reach_m = kHalfRoomM - obstacle.radius_m - clutter_.passage_m;
  const Eigen::Vector2d center(between(-reach_m, reach_m), between(-reach_m, reach_m));
  const double yaw_rad = between(-geometry::kPi, geometry::kPi);
  const bool is_taken = std::ranges::any_of(taken_, [&](const Circle& other) {
    return (center - other.center).norm() < obstacle.radius_m + other.radius_m + clutter_.passage_m;
  });
  if (is_taken || center.norm() < obstacle.radius_m + kStartFreeM) {
    return false;
  }
  taken_.push_back({center, obstacle.radius_m});
  const geometry::SE2 T_world_obstacle{center.x(), center.y(), yaw_rad};
  for (Object object : obstacle.objects) {
    if (auto* box = std::get_if<Box>(&object.shape)) {
      box->center.head<2>() = T_world_obstacle * Eigen::Vector2d(box->center.head<2>());
      box->yaw_rad = yaw_rad;
    } else if (auto* cylinder = std::get_if<Cylinder>(&object.shape)) {
      cylinder->center.head<2>() = T_world_obstacle * Eigen::Vector2d(cylinder->center.head<2>());
    }
    world.objects.push_back(object);
  }
  return true;
}

}  // namespace

World random_clutter(std::uint64_t seed) {
  return Maker({"random", kWidePassageM, 25, 40}, seed).make();
}

World dense_clutter(std::uint64_t seed) {
  return Maker({"dense", kNarrowPassageM, 40, 60}, seed).make();
}

World clutter_with_goal(std::uint64_t seed) {
  return Maker({"goals", kNarrowPassageM, 40, 60}, seed).make_with_goal();
}

World clutter_with_dock(std::uint64_t seed) {
  return Maker({"dock", kNarrowPassageM, 25, 40}, seed).make_with_dock();
}

}  // namespace nodmap::sim
