// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "modules/explorer/planning_grid.hpp"
#include "modules/explorer/shortest_paths.hpp"

namespace nodmap::explorer {

/// The borders between the free space that the robot can reach and unknown ground.
class Frontiers {
 public:
  /// Finds the frontier cells: free, next to unknown ground (4-neighbourhood), and reached or at
  /// most 0.4 m, over free cells, from a reached cell.
  void find(const Reach& reach);

  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }

  /// Lookouts, from which the robot could see a frontier: one reached cell of each block of 0.4 m x
  /// 0.4 m within `max_m`, over free cells, of a frontier; the nearest by path first.
  [[nodiscard]] std::vector<Cell> lookouts(const Reach& reach, double max_m);

 private:
  /// Marks, and calls `visit` for, each free cell within `max_steps` steps of `from` over free
  /// cells.
  template <class Visit>
  void spread(const PlanningGrid& grid, const std::vector<Cell>& from, int max_steps, Visit visit);

  std::vector<Cell> cells_;
  Marks visited_;  // by the last spread()
};

}  // namespace nodmap::explorer
