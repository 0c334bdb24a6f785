// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/shortest_paths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace nodmap::explorer {
namespace {

// A path starts this near to the robot, along x and y.
constexpr double kAroundM = 0.4;
constexpr std::uint8_t kNoParent = 8;
constexpr std::uint32_t kStraight = 5;
constexpr std::uint32_t kDiagonal = 7;
// Number of cells at the end of a path that determine its heading.
constexpr int kHeadingCells = 4;

const std::array<Cell, 8> kNeighbours{Cell(1, 0), Cell(-1, 0), Cell(0, 1),  Cell(0, -1),
                                      Cell(1, 1), Cell(-1, 1), Cell(1, -1), Cell(-1, -1)};

}  // namespace

void ShortestPaths::compute(const PlanningGrid& grid, const Eigen::Vector2d& from_map,
                            std::span<const Cell> targets) {
  const Raster<Ground>& ground = grid.ground();
  cell_size_m_ = grid.cell_size_m();
  length_fifths_.reset(ground.first(), ground.width(), ground.height(), kUnreached);
  parent_.reset(ground.first(), ground.width(), ground.height(), kNoParent);
  cells_.clear();
  for (auto& bucket : buckets_) {
    bucket.clear();
  }
  num_queued_ = 0;
  seed(grid, from_map);
  std::size_t num_missing = targets.size();
  std::vector<Cell> open;
  for (std::uint32_t fifths = 0; num_queued_ > 0; ++fifths) {
    open.swap(buckets_[fifths % kNumBuckets]);
    buckets_[fifths % kNumBuckets].clear();
    num_queued_ -= open.size();
    for (const Cell& cell : open) {
      if (length_fifths_.at(cell) == fifths) {  // otherwise a shorter path has reached it meanwhile
        cells_.push_back(cell);
        push_neighbours(grid, cell, fifths);
      }
    }
    num_missing -= static_cast<std::size_t>(std::ranges::count_if(targets, [&](const Cell& target) {
      return length_fifths_.contains(target) && length_fifths_.at(target) == fifths;
    }));
    open.clear();
    if (!targets.empty() && num_missing == 0) {
      break;
    }
  }
}

void ShortestPaths::seed(const PlanningGrid& grid, const Eigen::Vector2d& from_map) {
  const Cell middle = grid.cell_of(from_map);
  const auto around = static_cast<int>(kAroundM / cell_size_m_);
  std::optional<Cell> nearest;
  for (int dy = -around; dy <= around; ++dy) {
    for (int dx = -around; dx <= around; ++dx) {
      const Cell offset(dx, dy);
      if (grid.is_passable(middle + offset) &&
          (!nearest || offset.squaredNorm() < nearest->squaredNorm())) {
        nearest = offset;
      }
    }
  }
  if (nearest) {
    push(middle + *nearest, 0, kNoParent);
  }
}

void ShortestPaths::push(const Cell& cell, std::uint32_t fifths, std::uint8_t parent) {
  std::uint32_t& known = length_fifths_.at(cell);
  if (fifths < known) {
    known = fifths;
    parent_.at(cell) = parent;
    buckets_[fifths % kNumBuckets].push_back(cell);
    ++num_queued_;
  }
}

double ShortestPaths::length_m(const Cell& cell) const {
  return is_reached(cell) ? cell_size_m_ / kStraight * length_fifths_.at(cell)
                          : std::numeric_limits<double>::infinity();
}

void ShortestPaths::push_neighbours(const PlanningGrid& grid, const Cell& cell,
                                    std::uint32_t fifths) {
  for (std::size_t i = 0; i < kNeighbours.size(); ++i) {
    const Cell next = cell + kNeighbours.at(i);
    if (grid.is_passable(next)) {
      push(next, fifths + (i < 4 ? kStraight : kDiagonal), static_cast<std::uint8_t>(i));
    }
  }
}

std::vector<Cell> ShortestPaths::path_to(const Cell& cell) const {
  std::vector<Cell> path{cell};
  while (parent_.at(path.back()) != kNoParent) {
    const Cell before = path.back() - kNeighbours.at(parent_.at(path.back()));
    path.push_back(before);
  }
  std::ranges::reverse(path);
  return path;
}

double ShortestPaths::heading_rad(const Cell& cell, double otherwise_rad) const {
  Cell before = cell;
  for (int i = 0; i < kHeadingCells && parent_.at(before) != kNoParent; ++i) {
    before -= kNeighbours.at(parent_.at(before));
  }
  const Cell along = cell - before;
  return along.isZero() ? otherwise_rad : std::atan2(along.y(), along.x());
}

std::vector<Eigen::Vector2d> Reach::path_to(const Cell& cell) const {
  std::vector<Eigen::Vector2d> path_map;
  for (const Cell& on_path : paths.path_to(cell)) {
    path_map.push_back(grid.center_of(on_path));
  }
  return path_map;
}

}  // namespace nodmap::explorer
