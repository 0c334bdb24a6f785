// SPDX-License-Identifier: BSD-3-Clause
// The trajectories, images and metrics that are written with --out.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>

#include "common/drawing/image.hpp"
#include "common/geometry/se2.hpp"
#include "modules/slam2d/back_end/tracked_path.hpp"
#include "modules/slam2d/grid/occupancy_grid.hpp"
#include "modules/slam2d/pose_update.hpp"
#include "modules/slam2d/scan/level_scan_input.hpp"

namespace nodmap::slam2d {

/// Draws the map with the path on it, y up, with a scale bar, a legend, and marks where the path
/// starts and ends. The longer side has 1200 pixels, or one for each cell if that is more.
[[nodiscard]] drawing::Image draw_map(const OccupancyGrid& grid,
                                      std::span<const geometry::SE2> path);

/// Draws the corrected path, and the path by odometry in grey, with the same scale bar, legend and
/// marks as draw_map().
[[nodiscard]] drawing::Image draw_paths(std::span<const geometry::SE2> path,
                                        std::span<const geometry::SE2> odometry);

/// Writes trajectory.tum with the `corrected` pose of each scan, and online.tum with the poses that
/// were published.
void write_trajectories(const std::filesystem::path& dir, std::span<const TrackedScan> scans,
                        std::span<const geometry::SE2> corrected);

/// The counts of scans in result.json.
[[nodiscard]] nlohmann::json scan_metrics(const ScansByState& scans, const ScanCounts& rejected);

/// Logs how many scans were tracked, degraded and lost: as a warning if most were lost, because the
/// process has done all that it could and ends well.
void log_scans(const ScansByState& scans);

}  // namespace nodmap::slam2d
