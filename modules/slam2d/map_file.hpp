// SPDX-License-Identifier: BSD-3-Clause
// The map and the path as files: for the ROS map_server, and as images.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <system_error>

#include "common/drawing/image.hpp"
#include "common/geometry/se2.hpp"
#include "modules/slam2d/known_map.hpp"
#include "modules/slam2d/occupancy_grid.hpp"

namespace nodmap::slam2d {

/// Writes map.pgm and map.yaml as the ROS map_server reads them. At every moment an existing
/// map.yaml names a complete image that belongs to it: while the files are replaced, that is a copy
/// of the old one, map.previous.pgm.
[[nodiscard]] std::error_code write_ros_map(const std::filesystem::path& dir,
                                            const OccupancyGrid& grid);

/// Reads a map as the ROS map_server does: `path` is a map.yaml, or a folder with one. The image
/// it names is a PGM file (P2 or P5). Throws formats::InputFileError naming the file and what is
/// wrong.
[[nodiscard]] TrinaryGrid read_ros_map(const std::filesystem::path& path);

/// Draws the map with the path on it, y up, with a scale bar, a legend, and marks where the path
/// starts and ends. The longer side has 1200 pixels, or one for each cell if that is more.
[[nodiscard]] drawing::Image draw_map(const OccupancyGrid& grid,
                                      std::span<const geometry::SE2> path);

/// Draws the corrected path, and the path by odometry in grey, with the same scale bar, legend and
/// marks as draw_map().
[[nodiscard]] drawing::Image draw_paths(std::span<const geometry::SE2> path,
                                        std::span<const geometry::SE2> odometry);

}  // namespace nodmap::slam2d
