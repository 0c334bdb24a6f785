// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "modules/explorer/planning_grid.hpp"
#include "modules/explorer/shortest_paths.hpp"

namespace nodmap::explorer {

/// Where the known free space that the robot can reach ends at unknown ground.
class Frontiers {
 public:
  /// Frontier cells: free, beside unknown ground (4-neighbourhood), and either reached or not
  /// farther than 0.4 m, over free cells, from a reached cell.
  void find(const PlanningGrid& grid, const ShortestPaths& paths);

  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }

  /// A reached cell of each block of 0.4 m x 0.4 m that lies within `max_m`, over free cells, of a
  /// frontier; the nearest ones by path first. From there the robot may look at it.
  [[nodiscard]] std::vector<Cell> lookouts(const PlanningGrid& grid, const ShortestPaths& paths,
                                           double max_m);

 private:
  /// Calls `visit` for each free cell within `max_steps` of `from`, over free cells.
  template <class Visit>
  void spread(const PlanningGrid& grid, const std::vector<Cell>& from, int max_steps, Visit visit);

  std::vector<Cell> cells_;
  Raster<std::uint32_t> visited_;  // in which spread a cell was visited last
  std::uint32_t num_spreads_ = 0;
};

}  // namespace nodmap::explorer
