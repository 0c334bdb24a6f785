// SPDX-License-Identifier: BSD-3-Clause
// The map as files for the ROS map_server.
#pragma once

#include <cstdint>
#include <filesystem>
#include <system_error>

#include "modules/slam2d/grid/occupancy_grid.hpp"
#include "modules/slam2d/grid/trinary_grid.hpp"

namespace nodmap::slam2d {

// Grey values of map.pgm.
inline constexpr std::uint8_t kOccupiedGrey = 0;
inline constexpr std::uint8_t kUnknownGrey = 205;
inline constexpr std::uint8_t kFreeGrey = 254;

/// The grey value of a cell.
[[nodiscard]] std::uint8_t grey_of(const OccupancyGrid& grid, int x, int y);

/// Writes map.pgm and map.yaml as the ROS map_server reads them. At every moment an existing
/// map.yaml names a complete image that belongs to it: while the files are replaced, that is a copy
/// of the old one, map.previous.pgm.
[[nodiscard]] std::error_code write_ros_map(const std::filesystem::path& dir,
                                            const OccupancyGrid& grid);

/// Reads a map as the ROS map_server does: `path` is a map.yaml, or a folder with one. The image
/// it names is a PGM file (P2 or P5). Throws formats::InputFileError naming the file and what is
/// wrong.
[[nodiscard]] TrinaryGrid read_ros_map(const std::filesystem::path& path);

}  // namespace nodmap::slam2d
