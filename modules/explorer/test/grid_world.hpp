// SPDX-License-Identifier: BSD-3-Clause
// For closed-loop tests: a world of cells, the 2D map that an ideal SLAM would build of it, and a
// robot that follows the explorer's path.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "modules/explorer/explorer.hpp"

namespace nodmap::explorer::test {

/// Walls on a grid of 5 cm, and the part of it seen so far. Frame map.
class GridWorld {
 public:
  static constexpr double kCellM = 0.05;

  GridWorld(const Eigen::Vector2d& min, const Eigen::Vector2d& max)
      : first_((min / kCellM).array().floor().cast<int>()),
        width_(static_cast<int>(std::ceil((max - min).x() / kCellM))),
        height_(static_cast<int>(std::ceil((max - min).y() / kCellM))),
        is_wall_(static_cast<std::size_t>(width_ * height_), false),
        map_(is_wall_.size(), -1) {}

  /// Adds an occupied rectangle.
  void add_box(const Eigen::Vector2d& min, const Eigen::Vector2d& max) {
    for (std::size_t i = 0; i < is_wall_.size(); ++i) {
      const Eigen::Vector2d p = center(i);
      if ((p.array() >= min.array()).all() && (p.array() <= max.array()).all()) {
        is_wall_[i] = true;
      }
    }
  }
  /// Adds a wall along x or y, 10 cm thick.
  void add_wall(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const Eigen::Vector2d half = Eigen::Vector2d::Constant(0.05);
    add_box(from.cwiseMin(to) - half, from.cwiseMax(to) + half);
  }
  void add_wall_with_door(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double middle_m,
                          double width_m) {
    const Eigen::Vector2d along = (to - from).normalized();
    add_wall(from, from + (middle_m - 0.5 * width_m) * along);
    add_wall(from + (middle_m + 0.5 * width_m) * along, to);
  }

  /// Takes a scan with one beam per degree ahead, up to 8 m.
  void scan(const geometry::SE2& T_map_base) {
    constexpr double kRangeM = 8.0;
    const Eigen::Vector2d mirror = T_map_base * Eigen::Vector2d(0.15, 0.0);
    for (int degree = -90; degree <= 90; ++degree) {
      const double angle_rad = T_map_base.yaw + geometry::deg_to_rad(degree);
      const Eigen::Vector2d along(std::cos(angle_rad), std::sin(angle_rad));
      for (double range_m = 0.0; range_m < kRangeM; range_m += 0.5 * kCellM) {
        const Eigen::Vector2d p = mirror + range_m * along;
        if (!contains(p)) {
          break;
        }
        map_[index(p)] = is_wall(p) ? 100 : 0;
        if (is_wall(p)) {
          break;
        }
      }
    }
  }

  [[nodiscard]] MapTile map() const { return {kCellM, first_, width_, height_, map_}; }

  /// The floor cells connected with `start`, without those next to walls, which beams hit only by
  /// chance.
  [[nodiscard]] std::vector<std::size_t> floor(const Eigen::Vector2d& start) const {
    std::vector<bool> visited(is_wall_.size(), false);
    std::vector<std::size_t> front{index(start)};
    visited[front.front()] = true;
    std::vector<std::size_t> cells;
    while (!front.empty()) {
      const std::size_t at = front.back();
      front.pop_back();
      bool beside_wall = false;
      for (int i = 0; i < 9; ++i) {
        const Eigen::Vector2d p = center(at) + kCellM * Eigen::Vector2d(i % 3 - 1, i / 3 - 1);
        beside_wall = beside_wall || !contains(p) || is_wall(p);
        if (contains(p) && !is_wall(p) && !visited[index(p)]) {
          visited[index(p)] = true;
          front.push_back(index(p));
        }
      }
      if (!beside_wall) {
        cells.push_back(at);
      }
    }
    return cells;
  }

  /// The fraction of these cells that the map shows as free.
  [[nodiscard]] double seen_ratio(const std::vector<std::size_t>& cells) const {
    const auto num_seen =
        std::ranges::count_if(cells, [this](std::size_t cell) { return map_[cell] == 0; });
    return static_cast<double>(num_seen) / static_cast<double>(cells.size());
  }

 private:
  [[nodiscard]] bool contains(const Eigen::Vector2d& p) const {
    const Cell c = (p / kCellM).array().floor().cast<int>().matrix() - first_;
    return c.x() >= 0 && c.y() >= 0 && c.x() < width_ && c.y() < height_;
  }
  [[nodiscard]] std::size_t index(const Eigen::Vector2d& p) const {
    const Cell c = (p / kCellM).array().floor().cast<int>().matrix() - first_;
    return static_cast<std::size_t>(c.y() * width_ + c.x());
  }
  [[nodiscard]] Eigen::Vector2d center(std::size_t i) const {
    const auto at = static_cast<int>(i);
    return kCellM * (first_ + Cell(at % width_, at / width_)).cast<double>().array() + 0.5 * kCellM;
  }
  [[nodiscard]] bool is_wall(const Eigen::Vector2d& p) const { return is_wall_[index(p)]; }

  Cell first_;
  int width_;
  int height_;
  std::vector<bool> is_wall_;
  std::vector<std::int8_t> map_;
};

/// Rooms on both sides of a corridor along x, each with a door and a cupboard in a corner; the
/// robot starts at the start of the corridor, 0.6 m from the wall behind it.
inline GridWorld make_office(int rooms_on_a_side, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  const auto between = [&](double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(engine);
  };
  const double half_m = 0.5 * between(1.6, 2.2);
  const double room_m = between(3.2, 4.4);
  const double end_m = room_m * rooms_on_a_side;
  GridWorld office({-1.2, -6.5}, {end_m, 6.5});
  for (const double side : {-1.0, 1.0}) {
    const double y_corridor = side * (half_m + 0.05);
    const double y_outside = y_corridor + side * between(3.0, 4.5);
    for (int i = 0; i < rooms_on_a_side; ++i) {
      const double x = room_m * i - 0.6;
      office.add_wall_with_door({x, y_corridor}, {x + room_m, y_corridor},
                                between(0.7, room_m - 0.7), between(0.7, 0.95));
      office.add_wall({x, y_corridor}, {x, y_outside});
      const Eigen::Vector2d corner(x + 0.15, y_outside - side * 0.15);
      const Eigen::Vector2d opposite = corner + Eigen::Vector2d(0.5, -side * 0.4);
      office.add_box(corner.cwiseMin(opposite), corner.cwiseMax(opposite));
    }
    office.add_wall({-0.6, y_outside}, {end_m - 0.6, y_outside});
    office.add_wall({end_m - 0.6, y_corridor}, {end_m - 0.6, y_outside});
  }
  office.add_wall({-0.6, -half_m}, {-0.6, half_m});
  office.add_wall({end_m - 0.6, -half_m}, {end_m - 0.6, half_m});
  return office;
}

/// The result of an exploration.
struct Exploration {
  State state = State::kIdle;
  double seen_ratio = 0.0;
  double from_home_m = 0.0;
};

/// Explores from the origin until the robot is home, for at most `max_s`. The robot drives at 0.5
/// m/s along the path and rotates at 60 degrees per second on the spot. The map is updated twice a
/// second; there is a scan every 0.3 m or 15 degrees.
inline Exploration explore(GridWorld& world, const ExplorerParams& params, double max_s) {
  constexpr double kStepS = 0.1;
  constexpr double kAheadM = 0.15;  // of the point of the path that the robot steers to
  constexpr double kStepRad = geometry::deg_to_rad(60.0) * kStepS;
  constexpr double kOnTheSpotRad = 0.6;  // if it must rotate by more, it does not drive meanwhile
  const std::vector<std::size_t> floor = world.floor({0.0, 0.0});
  Explorer explorer(params);
  explorer.start();
  geometry::SE2 T_map_base;
  geometry::SE2 scanned_at{1e3, 0.0, 0.0};
  Decision decision;
  Exploration result;
  for (int step = 0; kStepS * step < max_s && explorer.state() != State::kHome; ++step) {
    if (std::hypot(T_map_base.x - scanned_at.x, T_map_base.y - scanned_at.y) > 0.3 ||
        std::abs(geometry::angle_difference(T_map_base.yaw, scanned_at.yaw)) >
            geometry::deg_to_rad(15.0)) {
      world.scan(T_map_base);
      scanned_at = T_map_base;
    }
    if (step % 5 == 0) {
      explorer.add(world.map());
      decision =
          explorer.decide({.stamp = time::Timestamp(100ms * step), .T_map_base = T_map_base});
      result.seen_ratio = world.seen_ratio(floor);
    }
    const Eigen::Vector2d p = T_map_base.translation();
    // Like the navigator, the robot stays at a goal until there is another one.
    if (!decision.goal || (decision.goal->p_map - p).norm() <= decision.goal->tolerance_m) {
      continue;
    }
    auto ahead = std::ranges::min_element(decision.path_map, {},
                                          [&](const auto& q) { return (q - p).norm(); });
    while (std::next(ahead) != decision.path_map.end() && (*ahead - p).norm() < kAheadM) {
      ++ahead;
    }
    const Eigen::Vector2d to = *ahead - p;
    const double off_rad = geometry::angle_difference(std::atan2(to.y(), to.x()), T_map_base.yaw);
    T_map_base.yaw =
        geometry::normalize_angle(T_map_base.yaw + std::clamp(off_rad, -kStepRad, kStepRad));
    if (std::abs(off_rad) < kOnTheSpotRad) {
      const double length_m = std::min(0.5 * kStepS, to.norm());
      const Eigen::Vector2d q = p + length_m * to.normalized();
      T_map_base.x = q.x();
      T_map_base.y = q.y();
    }
  }
  result.state = explorer.state();
  result.from_home_m = T_map_base.translation().norm();
  return result;
}

}  // namespace nodmap::explorer::test
