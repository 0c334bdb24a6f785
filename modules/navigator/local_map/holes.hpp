// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "modules/navigator/local_map/local_cell.hpp"

namespace nodmap::navigator {

/// A cell is the edge of a hole if a hole is this many cells away along an axis of the grid. A beam
/// passes through the floor up to a line's distance beyond the edge, and one that ends half on the
/// edge has seen floor where there is none.
inline constexpr int kEdgeCells = 2;
/// The offsets to the four such cells.
inline const std::array<Eigen::Vector2i, 4> kAcrossEdge{
    Eigen::Vector2i(kEdgeCells, 0), Eigen::Vector2i(-kEdgeCells, 0), Eigen::Vector2i(0, kEdgeCells),
    Eigen::Vector2i(0, -kEdgeCells)};

/// A beam of the scan number `scan` passed through the floor at `p_odom`. All uncertain beams
/// of a scan together count once, because they share errors of pitch and tilt. They do not count in
/// a cell where another beam of that scan has met the floor.
void add_hole(LocalGrid& grid, const Eigen::Vector2d& p_odom, bool is_certain, std::uint16_t scan,
              std::uint16_t travel_dm);

/// A beam passed through the floor at `p_odom`, but ended no lower than a ramp down could be.
void add_possible_ramp(LocalGrid& grid, const Eigen::Vector2d& p_odom);

/// Whether beams have passed through the floor in a cell, down to what may be a ramp, and in
/// another cell at most two away as well. A single cell may be noise, or be left over where lines
/// have met the floor around it.
[[nodiscard]] bool is_possible_ramp_down(const LocalGrid& grid, const Eigen::Vector2i& index);

}  // namespace nodmap::navigator
