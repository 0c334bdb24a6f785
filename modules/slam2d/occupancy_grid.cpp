// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/occupancy_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace nodmap::slam2d {
namespace {

constexpr int kMarginCells = 100;               // added on top of what is needed now
constexpr std::int64_t kMaxCells = 64'000'000;  // 400 m x 400 m at 5 cm
constexpr double kMaxCoordinateCells = 1'000'000'000.0;

bool is_drawable(const Eigen::Vector2d& cells) {
  return cells.allFinite() && cells.cwiseAbs().maxCoeff() < kMaxCoordinateCells;
}

/// The grid lines that a ray crosses along one axis (Amanatides and Woo 1987). The ray's parameter
/// runs from 0 at its origin to 1 at its end.
struct Axis {
  int direction = 0;
  double next = std::numeric_limits<double>::infinity();  // parameter where it enters the next cell
  double step = std::numeric_limits<double>::infinity();  // from cell to cell

  Axis(double from, double to) {
    if (from == to) {
      return;
    }
    direction = to > from ? 1 : -1;
    const double border = std::floor(from) + (direction > 0 ? 1.0 : 0.0);
    next = (border - from) / (to - from);
    step = 1.0 / std::abs(to - from);
  }
};

constexpr int kTileCells = 240;

GridTile cut_tile(const OccupancyGrid& grid, int x, int y) {
  GridTile tile;
  tile.x = x;
  tile.y = y;
  tile.width = std::min(kTileCells, grid.width() - x);
  tile.height = std::min(kTileCells, grid.height() - y);
  tile.cells.reserve(static_cast<std::size_t>(tile.width) * static_cast<std::size_t>(tile.height));
  for (int row = y; row < y + tile.height; ++row) {
    for (int column = x; column < x + tile.width; ++column) {
      tile.cells.push_back(grid.occupancy(column, row));
    }
  }
  return tile;
}

}  // namespace

OccupancyGrid::Cell& OccupancyGrid::at(const Eigen::Vector2i& cell) {
  const Eigen::Vector2i offset = cell - first_cell_;
  return cells_[static_cast<std::size_t>(offset.y()) * static_cast<std::size_t>(width_) +
                static_cast<std::size_t>(offset.x())];
}

bool OccupancyGrid::add_ray(const Eigen::Vector2d& sensor_origin, const Eigen::Vector2d& end) {
  return count_ray(sensor_origin, end, 1);
}

void OccupancyGrid::remove_ray(const Eigen::Vector2d& sensor_origin, const Eigen::Vector2d& end) {
  // One less, modulo 2^32.
  count_ray(sensor_origin, end, std::numeric_limits<std::uint32_t>::max());
}

bool OccupancyGrid::count_ray(const Eigen::Vector2d& sensor_origin, const Eigen::Vector2d& end,
                              std::uint32_t change) {
  const Eigen::Vector2d from = sensor_origin / cell_size_m_;
  const Eigen::Vector2d to = end / cell_size_m_;
  if (!is_drawable(from) || !is_drawable(to)) {
    return false;
  }
  Eigen::Vector2i cell = from.array().floor().cast<int>();
  const Eigen::Vector2i last = to.array().floor().cast<int>();
  if (!make_room(cell.cwiseMin(last), cell.cwiseMax(last))) {
    return false;
  }
  Axis x(from.x(), to.x());
  Axis y(from.y(), to.y());
  // One step for each grid line crossed, so that rounding cannot lead past the end.
  for (int steps = (last - cell).cwiseAbs().sum(); steps > 0; --steps) {
    at(cell).passed += change;
    const bool along_x = cell.y() == last.y() || (cell.x() != last.x() && x.next < y.next);
    Axis& axis = along_x ? x : y;
    (along_x ? cell.x() : cell.y()) += axis.direction;
    axis.next += axis.step;
  }
  at(last).ended += change;
  return true;
}

bool OccupancyGrid::make_room(const Eigen::Vector2i& low, const Eigen::Vector2i& high) {
  const Eigen::Vector2i end(first_cell_.x() + width_, first_cell_.y() + height_);
  const bool is_empty = cells_.empty();
  if (!is_empty && (low.array() >= first_cell_.array()).all() &&
      (high.array() < end.array()).all()) {
    return true;
  }
  const Eigen::Vector2i margin = Eigen::Vector2i::Constant(kMarginCells);
  const Eigen::Vector2i new_low =
      is_empty
          ? Eigen::Vector2i(low - margin)
          : Eigen::Vector2i((low.array() < first_cell_.array()).select(low - margin, first_cell_));
  const Eigen::Vector2i new_end =
      is_empty ? Eigen::Vector2i(high + margin)
               : Eigen::Vector2i((high.array() >= end.array()).select(high + margin, end));
  const Eigen::Vector2i size = new_end - new_low;
  if (static_cast<std::int64_t>(size.x()) * size.y() > kMaxCells) {
    return false;
  }
  std::vector<Cell> grown(static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y()));
  const Eigen::Vector2i shift = first_cell_ - new_low;
  for (std::ptrdiff_t row = 0; row < height_; ++row) {
    std::copy_n(cells_.begin() + row * width_, width_,
                grown.begin() + (row + shift.y()) * size.x() + shift.x());
  }
  cells_ = std::move(grown);
  first_cell_ = new_low;
  width_ = size.x();
  height_ = size.y();
  return true;
}

std::int8_t OccupancyGrid::occupancy(int x, int y) const {
  const Cell& cell = cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                            static_cast<std::size_t>(x)];
  const std::uint64_t rays = std::uint64_t{cell.ended} + cell.passed;
  return rays == 0
             ? kUnknown
             : static_cast<std::int8_t>((std::uint64_t{200} * cell.ended + rays) / (2 * rays));
}

std::vector<GridTile> cut_into_tiles(const OccupancyGrid& grid) {
  std::vector<GridTile> tiles;
  for (int y = 0; y < grid.height(); y += kTileCells) {
    for (int x = 0; x < grid.width(); x += kTileCells) {
      tiles.push_back(cut_tile(grid, x, y));
    }
  }
  return tiles;
}

}  // namespace nodmap::slam2d
