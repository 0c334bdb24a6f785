// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/frontiers.hpp"

#include <array>
#include <utility>

namespace nodmap::explorer {
namespace {

/// How far frontier cells may be beyond the cells that the robot's centre can reach, because the
/// laser sees into places where the body does not fit.
constexpr double kBesideReachM = 0.4;
constexpr int kFrontierBlockCells = 4;

const std::array<Cell, 4> kSides{Cell(1, 0), Cell(-1, 0), Cell(0, 1), Cell(0, -1)};

bool is_at_unknown(const PlanningGrid& grid, const Cell& cell) {
  for (const Cell& offset : kSides) {
    if (grid.ground_at(cell + offset) == Ground::kUnknown) {
      return true;
    }
  }
  return false;
}

int block_of(int index) {
  return index >= 0 ? index / kFrontierBlockCells
                    : -((kFrontierBlockCells - 1 - index) / kFrontierBlockCells);
}

}  // namespace

template <class Visit>
void Frontiers::spread(const PlanningGrid& grid, const std::vector<Cell>& from, int max_steps,
                       Visit visit) {
  const Raster<Ground>& ground = grid.ground();
  if (visited_.first() != ground.first() || visited_.width() != ground.width() ||
      visited_.height() != ground.height()) {
    visited_.reset(ground.first(), ground.width(), ground.height(), 0);
    num_spreads_ = 0;
  }
  ++num_spreads_;
  std::vector<Cell> front = from;
  for (const Cell& cell : from) {
    visited_.at(cell) = num_spreads_;
    visit(cell);
  }
  std::vector<Cell> next;
  for (int step = 0; step < max_steps && !front.empty(); ++step) {
    for (const Cell& cell : front) {
      for (const Cell& offset : kSides) {
        const Cell neighbour = cell + offset;
        if (grid.ground_at(neighbour) == Ground::kFree && visited_.at(neighbour) != num_spreads_) {
          visited_.at(neighbour) = num_spreads_;
          visit(neighbour);
          next.push_back(neighbour);
        }
      }
    }
    front = std::exchange(next, {});
  }
}

void Frontiers::find(const PlanningGrid& grid, const ShortestPaths& paths) {
  cells_.clear();
  const auto beside = static_cast<int>(kBesideReachM / grid.cell_size_m());
  spread(grid, paths.cells(), beside, [&](const Cell& cell) {
    if (is_at_unknown(grid, cell)) {
      cells_.push_back(cell);
    }
  });
}

std::vector<Cell> Frontiers::lookouts(const PlanningGrid& grid, const ShortestPaths& paths,
                                      double max_m) {
  spread(grid, cells_, static_cast<int>(max_m / grid.cell_size_m()), [](const Cell&) {});
  Raster<std::uint8_t> taken;
  const Raster<Ground>& ground = grid.ground();
  taken.reset({block_of(ground.first().x()), block_of(ground.first().y())},
              ground.width() / kFrontierBlockCells + 2, ground.height() / kFrontierBlockCells + 2,
              0);
  std::vector<Cell> lookouts;
  for (const Cell& cell : paths.cells()) {
    const Cell block(block_of(cell.x()), block_of(cell.y()));
    if (visited_.at(cell) == num_spreads_ && taken.at(block) == 0) {
      taken.at(block) = 1;
      lookouts.push_back(cell);
    }
  }
  return lookouts;
}

}  // namespace nodmap::explorer
