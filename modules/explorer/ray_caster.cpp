// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/ray_caster.hpp"

#include <cmath>
#include <utility>

#include "common/geometry/whole_steps.hpp"

namespace nodmap::explorer {
namespace {

// At this distance neighbouring beams are one cell apart; farther away some cells are missed.
constexpr double kFullDensityM = 4.0;

// Whether a step from cell to cell leads diagonally between two occupied cells.
bool is_corner_closed(const PlanningGrid& grid, const Cell& from, const Cell& to) {
  return from.x() != to.x() && from.y() != to.y() &&
         grid.ground_at({from.x(), to.y()}) == Ground::kOccupied &&
         grid.ground_at({to.x(), from.y()}) == Ground::kOccupied;
}

}  // namespace

const std::vector<std::uint32_t>& RayCaster::unknown_cells(const PlanningGrid& grid,
                                                           const Eigen::Vector2d& p_map,
                                                           double heading_rad) {
  cells_.clear();
  counted_.begin(grid.ground().size());
  const Eigen::Vector2d ahead(std::cos(heading_rad), std::sin(heading_rad));
  Eigen::Vector2d from_map = p_map + sensor_ahead_m_ * ahead;
  if (grid.ground_at(grid.cell_of(from_map)) != Ground::kFree) {
    from_map = p_map;
  }
  const double step_rad = grid.cell_size_m() / kFullDensityM;
  const int num_beams = geometry::whole_steps(params_.half_angle_rad, step_rad);
  for (int i = -num_beams; i <= num_beams; ++i) {
    cast(grid, from_map, heading_rad + step_rad * i);
  }
  return cells_;
}

void RayCaster::cast(const PlanningGrid& grid, const Eigen::Vector2d& from_map, double angle_rad) {
  const Raster<Ground>& ground = grid.ground();
  const Eigen::Vector2d step(std::cos(angle_rad), std::sin(angle_rad));
  Eigen::Vector2d p = from_map / grid.cell_size_m();
  const int num_steps = geometry::whole_steps(params_.range_m, grid.cell_size_m());
  int unknown_left = geometry::whole_steps(params_.unknown_depth_m, grid.cell_size_m());
  Cell cell = p.array().floor().cast<int>();
  for (int i = 0; i < num_steps && unknown_left > 0; ++i) {
    p += step;
    const Cell before = std::exchange(cell, p.array().floor().cast<int>());
    if (!ground.contains(cell) || is_corner_closed(grid, before, cell)) {
      return;
    }
    const std::size_t index = ground.index_of(cell);
    if (ground[index] == Ground::kOccupied) {
      return;
    }
    if (ground[index] == Ground::kUnknown) {
      --unknown_left;
      if (counted_.mark(index)) {
        cells_.push_back(static_cast<std::uint32_t>(index));
      }
    }
  }
}

}  // namespace nodmap::explorer
