// SPDX-License-Identifier: BSD-3-Clause
// Worlds whose obstacles are hard to see: low, transparent, thin.
#include <array>
#include <cmath>

#include "common/geometry/angle.hpp"
#include "sim/world/scenarios/builder.hpp"
#include "sim/world/scenarios/scenarios.hpp"

namespace nodmap::sim {
namespace {

constexpr double kHallHalfWidthM = 2.5;
constexpr double kEndM = 8.5;
// Free space beside an obstacle across the path.
constexpr double kPassageM = 0.9;

void add_hall(Builder& hall) {
  hall.walls_around({-1.2, -kHallHalfWidthM}, {kEndM, kHallHalfWidthM});
  hall.start(0.0, hall.between(-0.8, 0.8), hall.between(-0.4, 0.4));
  hall.goal(hall.between(6.9, 7.6), hall.between(-0.8, 0.8));
}

// The y of the middle of an obstacle of this width across the hall, so that one side is free.
double across(Builder& hall, double width_m) {
  const double free_m = 2.0 * kHallHalfWidthM - width_m;
  return hall.side() *
         (kHallHalfWidthM - 0.5 * width_m - hall.between(0.0, free_m - kPassageM) * 0.5);
}

}  // namespace

World make_sills(std::uint64_t seed) {
  Builder hall("sills", seed);
  add_hall(hall);
  for (const double x : {1.8, 3.6, 5.4}) {
    // A sill across most of the hall, or a plank anywhere on the path. The body clears 3 cm.
    const double height_m = hall.between(0.031, 0.06);
    if (hall.count(0, 1) == 0) {
      const double width_m = hall.between(2.5, 3.8);
      hall.box({x, across(hall, width_m)}, {hall.between(0.06, 0.2), width_m}, {0.0, height_m});
    } else {
      hall.box({x, hall.between(-0.6, 0.6)}, {hall.between(0.1, 0.25), hall.between(0.8, 1.6)},
               {0.0, height_m}, hall.between(-0.5, 0.5));
    }
  }
  return hall.finish();
}

World make_glass(std::uint64_t seed) {
  constexpr double kPaneM = 0.02;
  constexpr double kPostM = 0.06;
  Builder hall("glass", seed);
  add_hall(hall);
  for (const double x : {2.4, 5.0}) {
    const double width_m = hall.between(1.4, 3.0);
    const double y = across(hall, width_m);
    hall.box({x, y}, {kPaneM, width_m}, {0.0, 2.2}, 0.0, 0.0);
    // Its frame can be seen: a post at each end.
    for (const double side : {-1.0, 1.0}) {
      hall.box({x, y + side * 0.5 * (width_m + kPostM)}, {kPostM, kPostM}, {0.0, 2.2});
    }
  }
  return hall.finish();
}

World make_contact(std::uint64_t seed) {
  Builder hall("contact", seed);
  add_hall(hall);
  // The body is 0.47 m high: it runs into the pane, and beams pass above and below.
  hall.box({hall.between(3.2, 4.8), hall.between(-0.5, 0.5)},
           {hall.between(0.3, 1.2), hall.between(0.8, 1.6)}, {0.43, 0.45}, 0.0, 0.0);
  for (const double x : {0.8, 2.4, 5.6, 7.2}) {
    hall.box({x + hall.between(-0.3, 0.3), hall.side() * 2.1},
             {hall.between(0.3, 0.8), hall.between(0.3, 0.7)}, {0.0, hall.between(0.8, 1.6)},
             hall.between(-0.5, 0.5));
  }
  return hall.finish();
}

World make_drums(std::uint64_t seed) {
  Builder hall("drums", seed);
  add_hall(hall);
  // Rows across the hall with gaps just wide enough for the robot; every other row is shifted.
  const double gap_m = hall.between(0.55, 0.75);
  double shift = 0.0;
  for (double x = 1.4; x < 6.2; x += hall.between(0.8, 1.2)) {
    const double radius_m = hall.count(0, 1) == 0 ? 0.06 : 0.08;
    const double pitch_m = gap_m + 2.0 * radius_m;
    for (double y = -kHallHalfWidthM + 0.3 + shift * pitch_m; y < kHallHalfWidthM - 0.3;
         y += pitch_m) {
      hall.cylinder({x + hall.between(-0.1, 0.1), y}, radius_m, hall.between(0.3, 0.9));
    }
    shift = 0.5 - shift;
  }
  return hall.finish();
}

World make_ramps(std::uint64_t seed) {
  Builder hall("ramps", seed);
  constexpr std::array kSlopesDeg{5.0, 10.0, 12.0};
  const double slope = std::tan(geometry::deg_to_rad(kSlopesDeg[seed % 3]));
  const double half_m = 0.5 * hall.between(1.2, 2.2);
  const double length_m = hall.between(1.5, 3.0);
  const double height_m = slope * length_m;
  const double foot_m = hall.between(1.0, 1.8);
  const double top_m = foot_m + length_m;
  const int kind = static_cast<int>(seed / 3 % 3);  // up, over, down
  // A hill without a flat top, or with a platform.
  const double platform_m = kind == 1 && hall.count(0, 1) == 0 ? 0.0 : hall.between(1.0, 2.0);
  const double down_m = top_m + platform_m;
  hall.ramp({foot_m, 0.0, 0.0}, {top_m, 0.0, height_m}, 2.0 * half_m);
  if (platform_m > 0.0) {
    hall.box({0.5 * (top_m + down_m), 0.0}, {platform_m, 2.0 * half_m}, {0.0, height_m});
  }
  double end_m = down_m;
  if (kind == 1) {
    hall.ramp({down_m, 0.0, height_m}, {down_m + length_m, 0.0, 0.0}, 2.0 * half_m);
    end_m = down_m + length_m + 2.0;
  }
  hall.walls_around({-1.0, -half_m}, {end_m, half_m});
  if (kind == 2) {
    hall.start(end_m - 0.5, 0.0, geometry::kPi);
    hall.start_height(height_m);
    hall.goal(0.0, 0.0);
  } else {
    hall.start(0.0, 0.0, 0.0);
    hall.goal(kind == 1 ? end_m - 1.0 : end_m - 0.5, 0.0);
  }
  // The straight path as seen from above, as the driven path is measured.
  const World& world = hall.world();
  hall.task().shortest_path_m = (world.goals.back() - world.T_world_start.translation()).norm();
  return hall.finish();
}

}  // namespace nodmap::sim
