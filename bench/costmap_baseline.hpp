// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/scan/scan.hpp"

namespace nodmap::bench {

/// A straightforward implementation of the usual alternative to the paper's maps: a square grid of
/// 5 cm cells in odom, which moves along with the robot. Each beam clears the cells it crosses
/// (Bresenham) and marks the cell of its end point if this is at the robot's height.
class CostmapBaseline {
 public:
  static constexpr double kCellM = 0.05;
  static constexpr int kCells = 320;  // 16 m
  static constexpr double kReachM = 8.0;

  void add_scan(const scan::Scan& scan, const geometry::SE3& T_odom_base) {
    roll_to(T_odom_base.translation().head<2>());
    const Eigen::Vector3d mirror = T_odom_base * scan::point_in_base(scan, 0, 0.0);
    for (const auto& [p_base, beam] : projector_.hits(scan)) {
      clear_and_mark(mirror.head<2>(), (T_odom_base * p_base).head<2>(), p_base.z());
    }
  }

  [[nodiscard]] std::size_t occupied() const {
    return static_cast<std::size_t>(std::ranges::count(cells_, kOccupied));
  }

 private:
  static constexpr std::uint8_t kUnknown = 0;
  static constexpr std::uint8_t kFree = 1;
  static constexpr std::uint8_t kOccupied = 2;

  struct Cell {
    int x = 0;
    int y = 0;
  };

  [[nodiscard]] static Cell cell_of(const Eigen::Vector2d& p) {
    return {static_cast<int>(std::floor(p.x() / kCellM)),
            static_cast<int>(std::floor(p.y() / kCellM))};
  }

  [[nodiscard]] std::uint8_t* find(Cell c) {
    const int x = c.x - corner_.x;
    const int y = c.y - corner_.y;
    const bool inside = x >= 0 && y >= 0 && x < kCells && y < kCells;
    return inside ? &cells_[static_cast<std::size_t>(y * kCells + x)] : nullptr;
  }

  void roll_to(const Eigen::Vector2d& p_odom) {
    const Cell middle = cell_of(p_odom);
    const Cell corner{middle.x - kCells / 2, middle.y - kCells / 2};
    if (corner.x == corner_.x && corner.y == corner_.y) {
      return;
    }
    std::ranges::fill(rolled_, kUnknown);
    const int dx = corner.x - corner_.x;
    const int dy = corner.y - corner_.y;
    for (int y = std::max(0, -dy); y < std::min(kCells, kCells - dy); ++y) {
      const int from = std::max(0, -dx);
      const int count = std::min(kCells, kCells - dx) - from;
      if (count > 0) {
        std::copy_n(&cells_[static_cast<std::size_t>((y + dy) * kCells + from + dx)], count,
                    &rolled_[static_cast<std::size_t>(y * kCells + from)]);
      }
    }
    std::swap(cells_, rolled_);
    corner_ = corner;
  }

  void clear_and_mark(const Eigen::Vector2d& from, const Eigen::Vector2d& hit, double height_m) {
    const Eigen::Vector2d way = hit - from;
    const double length = way.norm();
    const bool in_reach = length < kReachM;
    const Cell end = cell_of(in_reach ? hit : from + way * (kReachM / length));
    Cell at = cell_of(from);
    const int dx = std::abs(end.x - at.x);
    const int dy = std::abs(end.y - at.y);
    const int step_x = at.x < end.x ? 1 : -1;
    const int step_y = at.y < end.y ? 1 : -1;
    int error = dx - dy;
    while (at.x != end.x || at.y != end.y) {
      if (auto* cell = find(at)) {
        *cell = kFree;
      }
      const int twice = 2 * error;
      if (twice > -dy) {
        error -= dy;
        at.x += step_x;
      }
      if (twice < dx) {
        error += dx;
        at.y += step_y;
      }
    }
    auto* cell = find(end);
    if (cell != nullptr && in_reach && height_m > 0.05 && height_m < 0.5) {
      *cell = kOccupied;
    }
  }

  scan::ScanProjector projector_;
  Cell corner_;
  std::vector<std::uint8_t> cells_ = std::vector<std::uint8_t>(std::size_t{kCells} * kCells);
  std::vector<std::uint8_t> rolled_ = cells_;
};

}  // namespace nodmap::bench
