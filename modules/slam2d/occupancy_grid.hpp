// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace nodmap::slam2d {

/// A 2D grid in the map frame. Counts for each cell the rays that ended in it and those that passed
/// through. Grows to hold whatever is drawn.
class OccupancyGrid {
 public:
  static constexpr std::int8_t kUnknown = -1;

  explicit OccupancyGrid(double cell_size_m) : cell_size_m_(cell_size_m) {}

  /// Draws a ray from the scanner to the point it hit, both in map, metres. Returns false, and
  /// draws nothing, for a ray that is not finite or needs a grid of more than 64 million cells.
  bool add_ray(const Eigen::Vector2d& sensor_origin, const Eigen::Vector2d& end);

  /// Takes back a ray that add_ray() has drawn.
  void remove_ray(const Eigen::Vector2d& sensor_origin, const Eigen::Vector2d& end);

  [[nodiscard]] double cell_size_m() const { return cell_size_m_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Outer corner of cell (0, 0) in map, metres.
  [[nodiscard]] Eigen::Vector2d origin() const { return cell_size_m_ * first_cell_.cast<double>(); }
  /// Per cent of the cell's rays that ended in it, or kUnknown where there were none.
  [[nodiscard]] std::int8_t occupancy(int x, int y) const;
  /// Whether at least a quarter of the rays ended here: many only graze the cell of a wall.
  [[nodiscard]] bool is_occupied(int x, int y) const { return occupancy(x, y) >= 25; }

 private:
  struct Cell {
    std::uint32_t ended = 0;
    std::uint32_t passed = 0;
  };

  bool count_ray(const Eigen::Vector2d& sensor_origin, const Eigen::Vector2d& end,
                 std::uint32_t change);
  [[nodiscard]] bool make_room(const Eigen::Vector2i& low, const Eigen::Vector2i& high);
  [[nodiscard]] Cell& at(const Eigen::Vector2i& cell);

  double cell_size_m_;
  Eigen::Vector2i first_cell_ = Eigen::Vector2i::Zero();
  int width_ = 0;
  int height_ = 0;
  std::vector<Cell> cells_;  // row by row, x fastest
};

/// A rectangle of a grid.
struct GridTile {
  int x = 0;  ///< its first cell in the grid
  int y = 0;
  int width = 0;
  int height = 0;
  std::vector<std::int8_t> cells;  ///< occupancy row by row, x fastest
};

/// Cuts a grid into tiles of at most 240 x 240 cells, so that the message of each stays below
/// 64 KiB.
[[nodiscard]] std::vector<GridTile> cut_into_tiles(const OccupancyGrid& grid);

}  // namespace nodmap::slam2d
