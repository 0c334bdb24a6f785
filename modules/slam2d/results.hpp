// SPDX-License-Identifier: BSD-3-Clause
// The images and metrics that are written with --out.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>

#include "common/drawing/image.hpp"
#include "common/geometry/se2.hpp"
#include "modules/slam2d/level_scan.hpp"
#include "modules/slam2d/occupancy_grid.hpp"
#include "modules/slam2d/pose_update.hpp"

namespace nodmap::slam2d {

/// Draws the map with the path on it, y up, with a scale bar, a legend, and marks where the path
/// starts and ends. The longer side has 1200 pixels, or one for each cell if that is more.
[[nodiscard]] drawing::Image draw_map(const OccupancyGrid& grid,
                                      std::span<const geometry::SE2> path);

/// Draws the corrected path, and the path by odometry in grey, with the same scale bar, legend and
/// marks as draw_map().
[[nodiscard]] drawing::Image draw_paths(std::span<const geometry::SE2> path,
                                        std::span<const geometry::SE2> odometry);

/// The counts of scans in result.json.
[[nodiscard]] nlohmann::json scan_metrics(const ScansByState& scans, const ScanCounts& rejected);

}  // namespace nodmap::slam2d
