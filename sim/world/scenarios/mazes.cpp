// SPDX-License-Identifier: BSD-3-Clause
// Worlds with narrow paths, or paths that at first lead away from the goal.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "common/geometry/angle.hpp"
#include "sim/world/scenarios/builder.hpp"
#include "sim/world/scenarios/scenarios.hpp"

namespace nodmap::sim {
namespace {

// Rows and columns of cells, and which of the walls between them are open.
class Maze {
 public:
  Maze(int columns, int rows)
      : columns_(columns),
        rows_(rows),
        open_right_(static_cast<std::size_t>(columns * rows)),
        open_up_(static_cast<std::size_t>(columns * rows)) {}

  // Opens walls: a spanning tree by depth-first search, and a few more for loops.
  void carve(Builder& chance) {
    std::vector<std::pair<int, int>> path{{0, 0}};
    std::vector<bool> seen(open_right_.size());
    seen[0] = true;
    while (!path.empty()) {
      const auto [x, y] = path.back();
      std::vector<std::pair<int, int>> next;
      for (const auto& [dx, dy] : kSteps) {
        if (is_inside(x + dx, y + dy) && !seen[at(x + dx, y + dy)]) {
          next.emplace_back(x + dx, y + dy);
        }
      }
      if (next.empty()) {
        path.pop_back();
        continue;
      }
      const auto to =
          next[static_cast<std::size_t>(chance.count(0, static_cast<int>(next.size()) - 1))];
      open_between(path.back(), to);
      seen[at(to.first, to.second)] = true;
      path.push_back(to);
    }
    for (int i = 0; i < 2; ++i) {
      const int x = chance.count(0, columns_ - 2);
      const int y = chance.count(0, rows_ - 1);
      open_between({x, y}, {x + 1, y});
    }
  }

  void build(Builder& world, double cell_m) const {
    for (int x = 0; x < columns_; ++x) {
      for (int y = 0; y < rows_; ++y) {
        const Eigen::Vector2d corner(cell_m * (x + 0.5), cell_m * (y + 0.5));  // upper right
        if (x + 1 < columns_ && !open_right_[at(x, y)]) {
          world.wall(corner, corner - Eigen::Vector2d(0.0, cell_m));
        }
        if (y + 1 < rows_ && !open_up_[at(x, y)]) {
          world.wall(corner, corner - Eigen::Vector2d(cell_m, 0.0));
        }
      }
    }
    const double half_m = 0.5 * cell_m;
    world.walls_around({-half_m, -half_m}, {cell_m * columns_ - half_m, cell_m * rows_ - half_m});
  }

 private:
  static constexpr std::array<std::pair<int, int>, 4> kSteps{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

  [[nodiscard]] bool is_inside(int x, int y) const {
    return x >= 0 && y >= 0 && x < columns_ && y < rows_;
  }
  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y * columns_ + x);
  }
  void open_between(const std::pair<int, int>& a, const std::pair<int, int>& b) {
    const std::size_t lower = at(std::min(a.first, b.first), std::min(a.second, b.second));
    (a.first != b.first ? open_right_ : open_up_)[lower] = true;
  }

  int columns_;
  int rows_;
  std::vector<bool> open_right_;
  std::vector<bool> open_up_;
};

}  // namespace

World make_maze(std::uint64_t seed) {
  Builder builder("maze", seed);
  const double cell_m = builder.between(1.0, 1.4);  // 0.1 m of it are wall
  const int columns = builder.count(4, 6);
  const int rows = builder.count(4, 5);
  Maze maze(columns, rows);
  maze.carve(builder);
  maze.build(builder, cell_m);
  builder.start(0.0, 0.0, builder.between(-geometry::kPi, geometry::kPi));
  builder.goal(cell_m * (columns - 1), cell_m * (rows - 1));
  return builder.finish();
}

World make_zigzag(std::uint64_t seed) {
  Builder corridor("zigzag", seed);
  const double width_m = corridor.between(1.8, 2.6);
  const double gap_m = corridor.between(0.6, 0.9);
  const double lane_m = corridor.between(0.7, 1.1);
  const int baffles = corridor.count(3, 6);
  double side = corridor.side();
  for (int i = 0; i < baffles; ++i) {
    const double x = 0.8 + (lane_m + 0.1) * i;
    corridor.wall({x, -side * 0.5 * width_m}, {x, side * (0.5 * width_m - gap_m)});
    side = -side;
  }
  const double end_m = 0.8 + (lane_m + 0.1) * (baffles - 1) + 1.6;
  corridor.walls_around({-0.8, -0.5 * width_m}, {end_m, 0.5 * width_m});
  corridor.start(0.0, 0.0, corridor.between(-0.5, 0.5));
  corridor.goal(end_m - 0.8, 0.0);
  return corridor.finish();
}

World make_dead_end(std::uint64_t seed) {
  constexpr double kWidthM = 0.7;
  Builder hall("dead-end", seed);
  const double length_m = hall.between(1.5, 4.0);
  const double end_m = 2.0 + length_m;
  hall.walls_around({-2.0, -3.0}, {end_m + 3.0, 3.0});
  const double half_m = 0.5 * kWidthM + 0.05;  // to the middle of the walls
  for (const double side : {-1.0, 1.0}) {
    hall.wall({2.0, side * half_m}, {end_m, side * half_m});
  }
  hall.wall({end_m, -half_m - 0.05}, {end_m, half_m + 0.05});
  // The start is in front of the dead end, or in it.
  const double start_m = seed % 2 == 0 ? hall.between(0.0, 1.0) : end_m - 0.5;
  hall.start(start_m, 0.0, hall.between(-0.1, 0.1));
  hall.goal(end_m + 1.5, hall.between(-1.0, 1.0));
  return hall.finish();
}

World make_slot(std::uint64_t seed) {
  Builder hall("slot", seed);
  hall.walls_around({-1.5, -2.5}, {6.0, 2.5});
  const bool is_corner = seed % 2 == 0;
  if (is_corner) {
    // The start is 6 cm from both walls, facing them.
    hall.start(-1.5 + 0.30, -2.5 + 0.30, hall.between(-0.85, -0.72) * geometry::kPi);
  } else {
    const double half_m = 0.5 * hall.between(0.43, 0.50);  // the body has 0.33
    const double depth_m = hall.between(0.6, 1.2);
    hall.box({-1.5 + 0.5 * depth_m, half_m + 0.2}, {depth_m, 0.4}, {0.0, 1.0});
    hall.box({-1.5 + 0.5 * depth_m, -half_m - 0.2}, {depth_m, 0.4}, {0.0, 1.0});
    // Facing out or in.
    hall.start(-1.5 + 0.32, 0.0, hall.count(0, 1) == 0 ? 0.0 : geometry::kPi);
  }
  hall.goal(hall.between(4.0, 5.0), hall.between(-1.5, 1.5));
  return hall.finish();
}

World make_doors(std::uint64_t seed) {
  Builder rooms("doors", seed);
  const double depth_m = rooms.between(3.0, 4.0);
  const int num_rooms = rooms.count(2, 3);
  constexpr double kHalfWidthM = 3.0;
  double side = rooms.side();
  for (int i = 1; i < num_rooms; ++i) {
    // Beside the straight path, on the other side in the next wall.
    const double door_y = side * rooms.between(1.6, 2.3);
    rooms.wall_with_door({depth_m * i, -kHalfWidthM}, {depth_m * i, kHalfWidthM},
                         kHalfWidthM + door_y, rooms.between(0.55, 0.60));
    side = -side;
  }
  rooms.walls_around({0.0, -kHalfWidthM}, {depth_m * num_rooms, kHalfWidthM});
  rooms.start(1.0, 0.0, rooms.between(-0.5, 0.5));
  rooms.goal(depth_m * num_rooms - 1.0, 0.0);
  return rooms.finish();
}

namespace {

// Builds rooms on both sides of a corridor; returns the middles of the rooms.
std::vector<Eigen::Vector2d> build_office(Builder& office) {
  constexpr int kRoomsOnASide = 5;
  constexpr double kWallM = 0.1;
  const double half_m = 0.5 * office.between(1.6, 2.2);
  const double room_m = office.between(3.2, 4.4);
  std::vector<Eigen::Vector2d> middles;
  const double end_m = room_m * kRoomsOnASide;
  std::array<double, 2> reach_m{};
  for (const double side : {-1.0, 1.0}) {
    const double depth_m = office.between(3.0, 4.5);
    const double y_corridor = side * (half_m + 0.5 * kWallM);
    const double y_outside = y_corridor + side * depth_m;
    reach_m[side > 0.0 ? 1 : 0] = std::abs(y_outside) - 0.5 * kWallM;
    for (int i = 0; i < kRoomsOnASide; ++i) {
      const double x = room_m * i;
      const double door_m = office.between(0.7, 0.95);
      office.wall_with_door({x, y_corridor}, {x + room_m, y_corridor},
                            office.between(0.7, room_m - 0.7), door_m);
      if (i > 0) {
        office.wall({x, y_corridor}, {x, y_outside});
      }
      middles.emplace_back(x + 0.5 * room_m, 0.5 * (y_corridor + y_outside));
      // A desk at the outer wall and a cupboard in a corner.
      office.box({x + office.between(1.2, room_m - 1.2), y_outside - side * 0.6}, {1.4, 0.7},
                 {0.70, 0.74});
      office.box({x + 0.4, y_outside - side * 0.35}, {0.5, 0.4}, {0.0, 1.8});
    }
  }
  office.walls_around({0.0, -reach_m[0]}, {end_m, reach_m[1]});
  office.start(0.6, 0.0, 0.0);
  return middles;
}

}  // namespace

World make_building(std::uint64_t seed) {
  Builder office("building", seed);
  static_cast<void>(build_office(office));
  return office.finish();
}

World make_office(std::uint64_t seed) {
  Builder office("office", seed);
  const std::vector<Eigen::Vector2d> rooms = build_office(office);
  const int room = office.count(0, static_cast<int>(rooms.size()) - 1);
  const Eigen::Vector2d& middle = rooms[static_cast<std::size_t>(room)];
  office.goal(middle.x(), middle.y());
  return office.finish();
}

World make_corridor(std::uint64_t seed) {
  constexpr double kLengthM = 100.0;
  Builder corridor("corridor", seed);
  const double half_m = 0.5 * corridor.between(2.2, 2.6);
  corridor.walls_around({-1.0, -half_m}, {kLengthM + 1.0, half_m});
  for (double x = corridor.between(5.0, 12.0); x < kLengthM - 3.0;
       x += corridor.between(6.0, 14.0)) {
    // A door frame, a box at the wall, or a fire extinguisher.
    const double side = corridor.side();
    const double depth_m = corridor.between(0.05, 0.15);
    corridor.box({x, side * (half_m - 0.5 * depth_m)}, {corridor.between(0.2, 1.2), depth_m},
                 {0.0, corridor.between(0.1, 2.0)});
  }
  // Boxes of 10 cm on the path, with room beside them.
  for (double x = corridor.between(18.0, 24.0); x < kLengthM - 5.0;
       x += corridor.between(18.0, 28.0)) {
    corridor.box({x, corridor.side() * corridor.between(0.1, 0.3)}, {0.3, 0.3}, {0.0, 0.1},
                 corridor.between(0.0, 1.5));
  }
  corridor.start(0.0, 0.0, 0.0);
  corridor.goal(kLengthM, 0.0);
  corridor.task().shortest_path_m = kLengthM;  // boxes are passed with some millimetres more
  return corridor.finish();
}

}  // namespace nodmap::sim
