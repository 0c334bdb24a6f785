// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/frontiers.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "common/geometry/whole_steps.hpp"

namespace nodmap::explorer {
namespace {

// How far frontier cells may be beyond the cells that the robot's centre can reach, because the
// laser sees into places where the body does not fit.
constexpr double kBesideReachM = 0.4;
constexpr int kLookoutBlockCells = 4;

const std::array<Cell, 4> kSides{Cell(1, 0), Cell(-1, 0), Cell(0, 1), Cell(0, -1)};

bool is_at_unknown(const PlanningGrid& grid, const Cell& cell) {
  return std::any_of(kSides.begin(), kSides.end(), [&](const Cell& offset) {
    return grid.ground_at(cell + offset) == Ground::kUnknown;
  });
}

// The block of lookouts that a cell is in.
Cell block_of(const Cell& cell) {
  return {floor_divide(cell.x(), kLookoutBlockCells), floor_divide(cell.y(), kLookoutBlockCells)};
}

}  // namespace

template <class Visit>
void Frontiers::spread(const PlanningGrid& grid, const std::vector<Cell>& from, int max_steps,
                       Visit visit) {
  const Raster<Ground>& ground = grid.ground();
  visited_.begin(ground.size());
  std::vector<Cell> front = from;
  for (const Cell& cell : from) {
    visited_.mark(ground.index_of(cell));
    visit(cell);
  }
  std::vector<Cell> next;
  for (int step = 0; step < max_steps && !front.empty(); ++step) {
    for (const Cell& cell : front) {
      for (const Cell& offset : kSides) {
        const Cell neighbour = cell + offset;
        if (grid.ground_at(neighbour) == Ground::kFree &&
            visited_.mark(ground.index_of(neighbour))) {
          visit(neighbour);
          next.push_back(neighbour);
        }
      }
    }
    front = std::exchange(next, {});
  }
}

void Frontiers::find(const Reach& reach) {
  cells_.clear();
  const int beside = geometry::whole_steps(kBesideReachM, reach.grid.cell_size_m());
  spread(reach.grid, reach.paths.cells(), beside, [&](const Cell& cell) {
    if (is_at_unknown(reach.grid, cell)) {
      cells_.push_back(cell);
    }
  });
}

std::vector<Cell> Frontiers::lookouts(const Reach& reach, double max_m) {
  spread(reach.grid, cells_, geometry::whole_steps(max_m, reach.grid.cell_size_m()),
         [](const Cell&) {});
  Raster<std::uint8_t> taken;
  const Raster<Ground>& ground = reach.grid.ground();
  taken.reset(block_of(ground.first()), ground.width() / kLookoutBlockCells + 2,
              ground.height() / kLookoutBlockCells + 2, 0);
  std::vector<Cell> lookouts;
  for (const Cell& cell : reach.paths.cells()) {
    const Cell block = block_of(cell);
    if (visited_.is_marked(ground.index_of(cell)) && taken.at(block) == 0) {
      taken.at(block) = 1;
      lookouts.push_back(cell);
    }
  }
  return lookouts;
}

}  // namespace nodmap::explorer
