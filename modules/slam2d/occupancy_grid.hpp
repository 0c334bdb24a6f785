// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace nodmap::slam2d {

/// A 2D grid that counts, for each cell, the rays that ended in it and those that went through.
/// Grows to hold whatever is drawn.
class OccupancyGrid {
 public:
  static constexpr std::int8_t kUnknown = -1;

  explicit OccupancyGrid(double cell_size_m) : cell_size_m_(cell_size_m) {}

  /// A ray from the scanner to the point it hit, both in map. Rays that are not finite or would
  /// need a grid beyond reason are left out; returns whether the ray was drawn.
  bool add_ray(const Eigen::Vector2d& eye, const Eigen::Vector2d& end);

  /// Takes a ray back that was added.
  void remove_ray(const Eigen::Vector2d& eye, const Eigen::Vector2d& end);

  [[nodiscard]] double cell_size_m() const { return cell_size_m_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Outer corner of cell (0, 0) in map, metres.
  [[nodiscard]] Eigen::Vector2d origin() const { return cell_size_m_ * first_cell_.cast<double>(); }
  /// 100 times the share of rays that ended in the cell, or kUnknown where none came.
  [[nodiscard]] std::int8_t occupancy(int x, int y) const;
  /// Whether at least a quarter of the rays ended here: a wall's cell is also grazed by many.
  [[nodiscard]] bool is_occupied(int x, int y) const { return occupancy(x, y) >= 25; }

 private:
  struct Cell {
    std::uint32_t ended = 0;
    std::uint32_t passed = 0;
  };

  bool count_ray(const Eigen::Vector2d& eye, const Eigen::Vector2d& end, std::uint32_t change);
  [[nodiscard]] bool make_room(const Eigen::Vector2i& low, const Eigen::Vector2i& high);
  [[nodiscard]] Cell& at(const Eigen::Vector2i& cell);

  double cell_size_m_;
  Eigen::Vector2i first_cell_ = Eigen::Vector2i::Zero();
  int width_ = 0;
  int height_ = 0;
  std::vector<Cell> cells_;  // row by row, x fastest
};

}  // namespace nodmap::slam2d
