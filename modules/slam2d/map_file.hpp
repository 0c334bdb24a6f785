// SPDX-License-Identifier: BSD-3-Clause
// The map and the path as files: for ROS map_server, and as pictures for people.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "common/drawing/image.hpp"
#include "common/geometry/se2.hpp"
#include "modules/slam2d/occupancy_grid.hpp"

namespace nodmap::slam2d {

/// map.pgm and map.yaml in the convention of ROS map_server. A file that is there already stays
/// until the new one is whole. Throws std::runtime_error naming the file.
void write_ros_map(const std::filesystem::path& dir, const OccupancyGrid& grid);

/// The map with the path on it.
[[nodiscard]] drawing::Image draw_map(const OccupancyGrid& grid,
                                      std::span<const geometry::SE2> path);

/// The corrected path, and the one by odometry in grey.
[[nodiscard]] drawing::Image draw_paths(std::span<const geometry::SE2> path,
                                        std::span<const geometry::SE2> odometry);

}  // namespace nodmap::slam2d
