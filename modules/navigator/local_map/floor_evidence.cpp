// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/floor_evidence.hpp"

#include <algorithm>
#include <utility>

namespace nodmap::navigator {
namespace {

// Floor points no farther apart than this count against a hole between them. A hole that fits in
// between is too narrow to matter.
constexpr double kDenseM = 0.05;

// There is floor in a cell between beams. `is_dense`: the beams are so close together that they
// count against a hole.
void fill_cell(LocalCell& cell, bool is_dense, std::uint16_t scan) {
  if (is_dense && cell.hole > 0 && cell.scan != scan) {
    cell.hole = evidence::less(cell.hole);
    cell.scan = scan;
  }
  if (is_dense) {
    cell.may_be_ramp = false;
  }
  if (!cell.is_hole()) {
    cell.set_floor();
  }
}

}  // namespace

void FloorEvidence::add(LocalGrid& grid, std::size_t beam, const Eigen::Vector2d& p_odom,
                        double ground_m, std::uint16_t scan) {
  LocalCell* cell = grid.find(p_odom);
  if (cell == nullptr) {
    return;
  }
  cell->set_floor();
  cell->may_be_ramp = false;
  if (cell->scan != scan) {
    cell->hole = evidence::less(cell->hole);
    // Floor below a table top is no contradiction.
    if (0.01 * cell->low_cm - ground_m < floor_tolerance_m_ + evidence::kCertainM) {
      cell->obstacle = evidence::less(cell->obstacle);
    }
    cell->scan = scan;
  }
  points_[beam] = {p_odom, true};
}

void FloorEvidence::end_scan(LocalGrid& grid, std::uint16_t scan) {
  const bool has_before = points_before_.size() == points_.size();
  for (std::size_t i = 1; i < points_.size(); ++i) {
    if (points_[i - 1].is_valid && points_[i].is_valid) {
      fill_line(grid, points_[i - 1].p_odom, points_[i].p_odom);
    }
    if (!has_before) {
      continue;
    }
    const Point corners[4] = {points_before_[i - 1], points_before_[i], points_[i - 1], points_[i]};
    if (std::ranges::all_of(corners, &Point::is_valid)) {
      fill_between(grid, corners, scan);
    }
  }
  std::swap(points_, points_before_);
}

// Between two beams of one scan.
void FloorEvidence::fill_line(LocalGrid& grid, const Eigen::Vector2d& from,
                              const Eigen::Vector2d& to) const {
  const double length_m = (to - from).norm();
  if (length_m > max_gap_m_) {
    return;
  }
  const int steps = static_cast<int>(length_m / grid.cell_size_m()) + 1;
  for (int step = 1; step < steps; ++step) {
    LocalCell* cell = grid.find(from + (to - from) * step / steps);
    if (cell != nullptr && !cell->is_hole()) {
      cell->set_floor();
    }
  }
}

// Between two beams of the last scan (corners 0 and 1) and the same two of this one (2 and 3).
void FloorEvidence::fill_between(LocalGrid& grid, const Point (&corners)[4],
                                 std::uint16_t scan) const {
  const Eigen::Vector2d& a = corners[0].p_odom;
  const Eigen::Vector2d across = corners[1].p_odom - a;
  const Eigen::Vector2d along = corners[2].p_odom - a;
  const Eigen::Vector2d far_across = corners[3].p_odom - corners[2].p_odom;
  const double longest_m = std::max(along.norm(), (corners[3].p_odom - corners[1].p_odom).norm());
  const double widest_m = std::max(across.norm(), far_across.norm());
  if (longest_m > max_gap_m_ || widest_m > max_gap_m_) {
    return;
  }
  const bool is_dense = longest_m <= kDenseM && widest_m <= kDenseM;
  const double step_m = 0.8 * grid.cell_size_m();
  const int rows = static_cast<int>(longest_m / step_m) + 1;
  const int columns = static_cast<int>(widest_m / step_m) + 1;
  for (int row = 0; row <= rows; ++row) {
    const double u = static_cast<double>(row) / rows;
    for (int column = 0; column <= columns; ++column) {
      const double w = static_cast<double>(column) / columns;
      LocalCell* cell = grid.find(a + u * along + w * ((1.0 - u) * across + u * far_across));
      if (cell != nullptr) {
        fill_cell(*cell, is_dense, scan);
      }
    }
  }
}

}  // namespace nodmap::navigator
