// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/holes.hpp"

namespace nodmap::navigator {

void add_hole(LocalGrid& grid, const Eigen::Vector2d& p_odom, bool is_certain, std::uint16_t scan,
              std::uint16_t travel_dm) {
  LocalCell* cell = grid.find(p_odom);
  if (cell == nullptr || (!is_certain && cell->scan == scan)) {
    return;
  }
  cell->hole = evidence::more(cell->hole, is_certain);
  cell->is_floor = false;
  cell->scan = scan;
  cell->seen_at_dm = travel_dm;
}

void add_possible_ramp(LocalGrid& grid, const Eigen::Vector2d& p_odom) {
  if (LocalCell* cell = grid.find(p_odom)) {
    cell->may_be_ramp = true;
  }
}

bool is_possible_ramp_down(const LocalGrid& grid, const Eigen::Vector2i& index) {
  const LocalCell& cell = grid.at(index);
  if (!cell.may_be_ramp || cell.is_hole()) {
    return false;
  }
  constexpr int kReach = 2;
  for (int dy = -kReach; dy <= kReach; ++dy) {
    for (int dx = -kReach; dx <= kReach; ++dx) {
      const Eigen::Vector2i at = index + Eigen::Vector2i(dx, dy);
      if (at != index && grid.contains(at) && (grid.at(at).may_be_ramp || grid.at(at).is_hole())) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace nodmap::navigator
