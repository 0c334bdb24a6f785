// SPDX-License-Identifier: BSD-3-Clause
#include "common/geometry/angle.hpp"
#include "sim/world/scenarios/builder.hpp"
#include "sim/world/scenarios/scenarios.hpp"

namespace nodmap::sim {
namespace {

// The hall: the start is at the origin, the goal about 7 m ahead.
constexpr double kBackM = -1.2;
constexpr double kAheadM = 8.4;
constexpr double kHalfWidthM = 2.6;
// Free space beside a hole: three times what the robot needs.
constexpr double kPassageM = 1.0;

void add_hall(Builder& hall) {
  hall.walls_around({kBackM, -kHalfWidthM}, {kAheadM, kHalfWidthM});
  const double yaw_rad = hall.between(-0.5, 0.5);
  hall.start(0.0, hall.between(-0.8, 0.8), yaw_rad);
  hall.goal(hall.between(6.8, 7.6), hall.between(-0.8, 0.8));
}

// A flight of stairs down across the path; one side of it is free.
World stairs_down(std::uint64_t seed) {
  Builder hall("holes-stairs", seed);
  add_hall(hall);
  const double width_m = hall.between(1.4, 2.2);
  const double y_min = hall.between(-kHalfWidthM, kHalfWidthM - kPassageM - width_m);
  constexpr double kTreadM = 0.3;
  constexpr double kRiserM = 0.17;
  double x = hall.between(2.0, 3.0);
  const int steps = hall.count(3, 6);
  for (int i = 1; i <= steps; ++i) {
    const double tread_m = i == steps ? 1.0 : kTreadM;  // the landing
    hall.pit({x, y_min}, {x + tread_m, y_min + width_m}, kRiserM * i);
    x += tread_m;
  }
  return hall.finish();
}

// An open hatch with its cover beside it.
World shaft(std::uint64_t seed) {
  Builder hall("holes-shaft", seed);
  add_hall(hall);
  const Eigen::Vector2d size(hall.between(0.6, 1.4), hall.between(0.6, 1.6));
  const Eigen::Vector2d min(hall.between(2.0, 4.0), -0.5 * size.y() + hall.between(-0.5, 0.5));
  hall.pit(min, min + size, hall.between(1.5, 4.0));
  hall.box({min.x() + 0.5 * size.x(), min.y() + size.y() + 0.5 * size.y() + 0.05}, size,
           {0.0, 0.02});
  return hall.finish();
}

// A trench from wall to wall with a bridge.
World trench(std::uint64_t seed) {
  Builder hall("holes-trench", seed);
  add_hall(hall);
  const double width_m = hall.between(0.3, 0.7);
  const double depth_m = hall.between(0.3, 1.2);
  const double bridge_m = hall.between(0.9, 1.3);
  const double y = hall.between(-kHalfWidthM + bridge_m, kHalfWidthM - bridge_m);
  const double x = hall.between(2.5, 4.0);
  hall.pit({x, -kHalfWidthM}, {x + width_m, y - 0.5 * bridge_m}, depth_m);
  hall.pit({x, y + 0.5 * bridge_m}, {x + width_m, kHalfWidthM}, depth_m);
  return hall.finish();
}

// Pits of all sizes, one in each part of the hall.
World pits(std::uint64_t seed) {
  Builder hall("holes-pits", seed);
  add_hall(hall);
  for (const double x : {1.2, 2.9, 4.6}) {
    for (const double y : {-1.3, 1.3}) {
      // Within its part of 1.7 m by 2.6 m, with half a passage to each neighbour.
      const Eigen::Vector2d size(hall.between(0.2, 0.7), hall.between(0.2, 1.4));
      const Eigen::Vector2d min(
          x + hall.between(0.0, 0.7 - size.x()),
          y - 0.5 * size.y() + hall.between(-0.4, 0.4) * (1.6 - size.y()) / 1.6);
      hall.pit(min, min + size, hall.between(0.08, 1.0));
    }
  }
  return hall.finish();
}

// The floor ends along a line beside the path, which the robot faces at the start.
World edge(std::uint64_t seed, const char* name, double depth_m) {
  Builder hall(name, seed);
  const double y_edge = hall.between(0.5, 1.1);
  const double y_wall = y_edge - hall.between(1.6, 2.4);
  hall.walls_around({kBackM, y_wall}, {kAheadM, 5.0});
  hall.pit({kBackM, y_edge}, {kAheadM, 5.0}, depth_m);
  const double y_start = 0.5 * (y_edge + y_wall) + hall.between(-0.2, 0.2);
  hall.start(0.0, y_start, hall.between(0.0, geometry::deg_to_rad(100.0)));
  hall.goal(hall.between(5.0, 7.0), y_start);
  // An obstacle on the path that has to be passed near the edge.
  const double x_box = hall.between(2.5, 3.5);
  hall.box({x_box, y_wall + 0.15}, {hall.between(0.3, 0.8), 0.3}, {0.0, hall.between(0.2, 1.0)});
  return hall.finish();
}

}  // namespace

World make_holes(std::uint64_t seed) {
  constexpr double kKerbM = 0.08;
  constexpr double kDockM = 1.0;
  switch (seed % 6) {
    case 0:
      return stairs_down(seed);
    case 1:
      return shaft(seed);
    case 2:
      return trench(seed);
    case 3:
      return pits(seed);
    case 4:
      return edge(seed, "holes-kerb", kKerbM);
    default:
      return edge(seed, "holes-dock", kDockM);
  }
}

}  // namespace nodmap::sim
