// SPDX-License-Identifier: BSD-3-Clause
// Halls and corridors in which people walk.
#include <utility>

#include "sim/world/scenarios/builder.hpp"
#include "sim/world/scenarios/scenarios.hpp"

namespace nodmap::sim {
namespace {

struct Line {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
};

Actor person(Builder& chance) {
  Actor actor;
  actor.radius_m = chance.between(0.2, 0.3);
  actor.height_m = chance.between(1.5, 1.9);
  return actor;
}

// An actor that walks back and forth between two places, starting anywhere between them.
Actor walk_to_and_fro(Builder& chance, const Line& line, double speed_mps) {
  Actor actor = person(chance);
  const double walk_s = (line.to - line.from).norm() / speed_mps;
  const double begin_s = -chance.between(0.0, 2.0) * walk_s;
  actor.path = {
      {begin_s, line.from}, {begin_s + walk_s, line.to}, {begin_s + 2.0 * walk_s, line.from}};
  actor.loop = true;
  return actor;
}

// People who walk one after the other through a corridor towards the robot.
World oncoming_flow(Builder& corridor, double interval_s, bool reacts) {
  constexpr double kFarM = 16.0;
  const double half_m = 0.5 * corridor.between(2.6, 3.4);
  corridor.walls_around({-5.0, -half_m}, {kFarM + 1.0, half_m});
  for (double begin_s = 0.0; begin_s < 90.0; begin_s += interval_s) {
    Actor actor = person(corridor);
    const double speed_mps = corridor.between(0.5, 1.5);
    const double y = corridor.between(-half_m + 0.4, half_m - 0.4);
    const double end_s = begin_s + (kFarM + 4.0) / speed_mps;
    actor.path = {{begin_s, {kFarM, y}}, {end_s, {-4.0, y}}};
    actor.appear_s = begin_s;
    actor.vanish_s = end_s;
    actor.reacts = reacts;
    corridor.actor(std::move(actor));
  }
  corridor.start(0.0, 0.0, 0.0);
  corridor.goal(12.0, 0.0);
  return corridor.finish();
}

// People who cross, come towards the robot, or overtake it.
World crossing(Builder& hall, bool reacts) {
  constexpr double kHalfWidthM = 4.0;
  hall.walls_around({-4.5, -kHalfWidthM}, {13.0, kHalfWidthM});
  const int count = hall.count(4, 8);
  for (int i = 0; i < count; ++i) {
    const double speed_mps = hall.between(0.5, 2.0);
    const double y = hall.between(-1.0, 1.0);
    Line line{{hall.between(1.5, 8.0), -3.5}, {hall.between(1.5, 8.0), 3.5}};
    if (i % 3 == 1) {
      line = {{12.5, y}, {1.2, hall.side() * hall.between(1.5, 3.0)}};
    } else if (i % 3 == 2) {
      line = {{-4.0, y}, {12.5, y}};
    }
    Actor actor = walk_to_and_fro(hall, line, speed_mps);
    if (i % 3 == 2) {
      // From behind: not before the robot has seen its surroundings.
      const double later_s = 6.0 - actor.path.front().time_s;
      for (Waypoint& waypoint : actor.path) {
        waypoint.time_s += later_s;
      }
    }
    actor.reacts = reacts;
    hall.actor(std::move(actor));
  }
  hall.start(0.0, 0.0, 0.0);
  hall.goal(9.0, hall.between(-1.0, 1.0));
  return hall.finish();
}

World people(const char* name, std::uint64_t seed, bool reacts) {
  Builder builder(name, seed);
  return seed % 3 == 2 ? oncoming_flow(builder, builder.between(3.0, 5.0), reacts)
                       : crossing(builder, reacts);
}

}  // namespace

World make_people(std::uint64_t seed) {
  return people("people", seed, false);
}

World make_reacting_people(std::uint64_t seed) {
  return people("reacting", seed, true);
}

}  // namespace nodmap::sim
