// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/planning_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/geometry/whole_steps.hpp"

namespace nodmap::explorer {
namespace {

// The widest gap in a wall that is filled: 0.3 m where map cells are 5 cm wide.
constexpr int kWallGapCells = 3;
// The grid grows in blocks of this many map cells, so that it seldom grows.
constexpr int kBlockCells = 256;
// Map cells farther from the origin than this are refused, so that indices stay exact.
constexpr int kFarthestCell = 1 << 20;

// 2D SLAM draws none smaller. Each changed cell changes all within the inflation radius: at 1 mm
// some 200,000.
constexpr double kSmallestCellM = 0.01;

// The planning cell of a map cell.
Cell halved(const Cell& map_cell) {
  return {floor_divide(map_cell.x(), 2), floor_divide(map_cell.y(), 2)};
}

// The first cell of a cell's block.
Cell block_begin(const Cell& map_cell) {
  return kBlockCells *
         Cell(floor_divide(map_cell.x(), kBlockCells), floor_divide(map_cell.y(), kBlockCells));
}

Ground ground_of(std::int8_t occupancy) {
  if (occupancy < 0) {
    return Ground::kUnknown;
  }
  return occupancy >= MapTile::kOccupiedPercent ? Ground::kOccupied : Ground::kFree;
}

bool is_plausible(const MapTile& tile) {
  return tile.width > 0 && tile.height > 0 && tile.cell_size_m >= kSmallestCellM &&
         std::isfinite(tile.cell_size_m) &&
         tile.cells.size() ==
             static_cast<std::size_t>(tile.width) * static_cast<std::size_t>(tile.height) &&
         tile.first.cwiseAbs().maxCoeff() < kFarthestCell && tile.width < kFarthestCell &&
         tile.height < kFarthestCell;
}

}  // namespace

void PlanningGrid::clear() {
  *this = PlanningGrid(inflation_radius_m_);
}

bool PlanningGrid::add(const MapTile& tile) {
  if (!is_plausible(tile)) {
    return false;
  }
  if (is_empty()) {
    cell_size_m_ = 2.0 * tile.cell_size_m;
    find_near_offsets();
  }
  if (2.0 * tile.cell_size_m != cell_size_m_ || !make_room(tile)) {
    return false;
  }
  Cell low = Cell::Constant(kFarthestCell);
  Cell high = -low;
  for (int row = 0; row < tile.height; ++row) {
    for (int column = 0; column < tile.width; ++column) {
      const Cell cell = tile.first + Cell(column, row);
      const Ground now = ground_of(
          tile.cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(tile.width) +
                     static_cast<std::size_t>(column)]);
      if (set(cell, now)) {
        low = low.cwiseMin(cell);
        high = high.cwiseMax(cell);
      }
    }
  }
  if (low.x() <= high.x()) {
    // The cells within the inflation radius, and those beside them, where gaps are filled.
    const Cell margin = Cell::Constant(reach_cells_ + 2 * kWallGapCells);
    update_planning_cells(halved(low - margin), halved(high + margin));
  }
  return true;
}

bool PlanningGrid::make_room(const MapTile& tile) {
  const Cell margin = Cell::Constant(reach_cells_ + 2 * kWallGapCells + 2);
  Cell low = tile.first - margin;
  Cell high = tile.first + Cell(tile.width - 1, tile.height - 1) + margin;
  if (map_.contains(low) && map_.contains(high)) {
    return true;
  }
  if (!map_.is_empty()) {
    low = low.cwiseMin(map_.first());
    high = high.cwiseMax(map_.first() + Cell(map_.width() - 1, map_.height() - 1));
  }
  low = block_begin(low);
  const Cell size = block_begin(high) - low + Cell::Constant(kBlockCells);
  if (std::int64_t{size.x()} * size.y() / 4 > kMaxCells) {
    return false;
  }
  map_.grow(low, size.x(), size.y(), Ground::kUnknown);
  num_near_.grow(low, size.x(), size.y(), 0);
  raw_.grow(low / 2, size.x() / 2, size.y() / 2, Ground::kUnknown);
  ground_.grow(low / 2, size.x() / 2, size.y() / 2, Ground::kUnknown);
  passable_.grow(low / 2, size.x() / 2, size.y() / 2, 0);
  return true;
}

void PlanningGrid::find_near_offsets() {
  const double map_cell_m = 0.5 * cell_size_m_;
  near_offsets_.clear();
  reach_cells_ = geometry::whole_steps(inflation_radius_m_, map_cell_m);
  for (int dy = -reach_cells_; dy <= reach_cells_; ++dy) {
    for (int dx = -reach_cells_; dx <= reach_cells_; ++dx) {
      if (map_cell_m * std::hypot(dx, dy) < inflation_radius_m_) {
        near_offsets_.emplace_back(dx, dy);
      }
    }
  }
}

// Returns whether that changes the map cell.
bool PlanningGrid::set(const Cell& map_cell, Ground now) {
  const Ground before = std::exchange(map_.at(map_cell), now);
  if (now == Ground::kOccupied && before != Ground::kOccupied) {
    add_near(map_cell, 1);
  } else if (now != Ground::kOccupied && before == Ground::kOccupied) {
    add_near(map_cell, -1);
  }
  return now != before;
}

// Updates the counts of near occupied cells. `change`: +1 if the map cell becomes occupied, -1 if
// it no longer is.
void PlanningGrid::add_near(const Cell& map_cell, int change) {
  for (const Cell& offset : near_offsets_) {
    std::uint16_t& count = num_near_.at(map_cell + offset);
    count = static_cast<std::uint16_t>(count + change);
  }
}

// Recomputes the planning cells of a rectangle from the map's cells.
void PlanningGrid::update_planning_cells(const Cell& low, const Cell& high) {
  for (int y = low.y(); y <= high.y(); ++y) {
    for (int x = low.x(); x <= high.x(); ++x) {
      raw_.at({x, y}) = raw_ground({x, y});
    }
  }
  for (int y = low.y(); y <= high.y(); ++y) {
    for (int x = low.x(); x <= high.x(); ++x) {
      update_planning_cell({x, y});
    }
  }
}

void PlanningGrid::update_planning_cell(const Cell& cell) {
  const Ground now = filled_ground(cell);
  const Ground before = std::exchange(ground_.at(cell), now);
  num_free_ += static_cast<int>(now == Ground::kFree) - static_cast<int>(before == Ground::kFree);
  passable_.at(cell) = static_cast<std::uint8_t>(now == Ground::kFree && has_room(cell));
}

Ground PlanningGrid::raw_ground(const Cell& cell) const {
  Ground ground = Ground::kUnknown;
  for (int i = 0; i < 4; ++i) {
    ground = std::max(ground, map_.at(2 * cell + Cell(i % 2, i / 2)));
  }
  return ground;
}

// Unknown cells between known ones: the beams of a scan diverge. A wall seen at a grazing angle
// has wider gaps, through which the body does not fit.
Ground PlanningGrid::filled_ground(const Cell& cell) const {
  const Ground raw = raw_.at(cell);
  if (raw != Ground::kUnknown) {
    return raw;
  }
  static const std::array<Cell, 4> kDirections{Cell(1, 0), Cell(0, 1), Cell(1, 1), Cell(1, -1)};
  Ground filled = Ground::kUnknown;
  for (const Cell& direction : kDirections) {
    const auto [ahead, steps_ahead] = next_known(cell, direction);
    const auto [behind, steps_behind] = next_known(cell, -direction);
    const int gap_cells = steps_ahead + steps_behind - 1;
    if (ahead == behind && gap_cells <= (ahead == Ground::kOccupied ? kWallGapCells : 1)) {
      filled = std::max(filled, ahead);
    }
  }
  return filled;
}

// The first known cell in a direction, and how many steps away it is.
std::pair<Ground, int> PlanningGrid::next_known(const Cell& cell, const Cell& direction) const {
  int steps = 1;
  Ground ground = Ground::kUnknown;
  for (; steps <= kWallGapCells; ++steps) {
    const Cell next = cell + steps * direction;
    ground = raw_.contains(next) ? raw_.at(next) : Ground::kUnknown;
    if (ground != Ground::kUnknown) {
      break;
    }
  }
  return {ground, steps};
}

// One of the four map cells suffices, so that planning does not close a door that the body fits
// through.
bool PlanningGrid::has_room(const Cell& cell) const {
  for (int i = 0; i < 4; ++i) {
    if (num_near_.at(2 * cell + Cell(i % 2, i / 2)) == 0) {
      return true;
    }
  }
  return false;
}

}  // namespace nodmap::explorer
