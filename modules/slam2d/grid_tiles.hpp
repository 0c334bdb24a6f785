// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "modules/slam2d/occupancy_grid.hpp"
#include "nodmap/grid_chunk_t.hpp"

namespace nodmap::slam2d {

/// The grid as messages of less than 64 KiB each.
[[nodiscard]] std::vector<nodmap::grid_chunk_t> cut_into_tiles(const OccupancyGrid& grid,
                                                               std::int64_t utime_us,
                                                               std::int64_t map_revision);

}  // namespace nodmap::slam2d
