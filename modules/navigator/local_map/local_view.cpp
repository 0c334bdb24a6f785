// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/local_view.hpp"

#include "modules/navigator/local_map/holes.hpp"

namespace nodmap::navigator {
namespace {

unsigned bits_of(const LocalCell& cell, const ObstacleMemory& obstacles) {
  unsigned bits = cell.is_floor ? LocalView::kFloor : 0U;
  if (cell.is_obstacle()) {
    bits |= obstacles.is_forgotten(cell) ? LocalView::kForgotten : LocalView::kBlocked;
  }
  if (cell.is_hole()) {
    bits |= LocalView::kBlocked;
  }
  return cell.is_cleared() ? bits | LocalView::kCleared : bits;
}

}  // namespace

LocalView::LocalView(const LocalGrid& grid, const ObstacleMemory& obstacles,
                     const Eigen::Vector2i& middle, int reach)
    : first_(middle - Eigen::Vector2i::Constant(reach)),
      size_(2 * reach + 1),
      cells_per_m_(1.0 / grid.cell_size_m()),
      bits_(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_)) {
  // A hole outside the square may have its edge inside.
  const Eigen::Vector2i margin = Eigen::Vector2i::Constant(kEdgeCells);
  const Eigen::Vector2i last = first_ + Eigen::Vector2i::Constant(size_ - 1);
  const Eigen::Vector2i grid_last = grid.first() + Eigen::Vector2i::Constant(grid.size() - 1);
  const Eigen::Vector2i from = (first_ - margin).cwiseMax(grid.first());
  const Eigen::Vector2i to = (last + margin).cwiseMin(grid_last);
  for (int y = from.y(); y <= to.y(); ++y) {
    for (int x = from.x(); x <= to.x(); ++x) {
      const LocalCell& cell = grid.at({x, y});
      const Eigen::Vector2i offset = Eigen::Vector2i(x, y) - first_;
      if (is_inside(offset)) {
        bits_[index_of(offset)] |= static_cast<std::uint8_t>(bits_of(cell, obstacles));
      }
      if (cell.is_hole()) {
        block_around_hole(grid, {x, y});
      }
    }
  }
}

void LocalView::block_around_hole(const LocalGrid& grid, const Eigen::Vector2i& index) {
  for (const Eigen::Vector2i& step : kAcrossEdge) {
    const Eigen::Vector2i offset = index + step - first_;
    if (is_inside(offset) && grid.contains(index + step)) {
      bits_[index_of(offset)] |= std::uint8_t{kBlocked};
    }
  }
}

}  // namespace nodmap::navigator
