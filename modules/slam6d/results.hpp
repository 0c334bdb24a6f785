// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "modules/slam6d/back_end/saved_map.hpp"
#include "modules/slam6d/occupancy/occupancy_map.hpp"
#include "modules/slam6d/slam6d.hpp"

namespace nodmap::slam6d {

/// trajectory.tum (with all that is known at the end) and online.tum (as known at the time). Throws
/// std::runtime_error.
void write_trajectories(const Slam6d& slam, const std::filesystem::path& dir);

/// Where the robot was at each sweep, in map. Without the sweeps before it was found in a saved
/// map.
struct DrivenPath {
  std::vector<Eigen::Vector3d> corrected;
  std::vector<Eigen::Vector3d> odometry;  ///< by odometry alone since the first of these sweeps
};
[[nodiscard]] DrivenPath driven_path(const Slam6d& slam);

/// cloud.ply, on request cloud.pcd, map.png and path.png. Throws std::runtime_error.
void write_cloud(const Slam6d& slam, bool with_pcd, const std::filesystem::path& dir);

/// Saves keyframes.lcmlog, map.bt and on request map.ot.
[[nodiscard]] std::error_code save_map(const std::filesystem::path& dir, const OccupancyMap& map,
                                       const SavedMap& keyframes, bool with_ot);

/// The loops that were accepted and refused.
[[nodiscard]] nlohmann::json loop_metrics(const BackEnd& back_end);

/// The same as a sentence: which keyframes were recognised where.
[[nodiscard]] std::string describe_loops(const BackEnd& back_end);

/// How the robot was found in a saved map. May be called only if slam.localiser() exists.
[[nodiscard]] nlohmann::json localisation_metrics(const Slam6d& slam);

/// Logs how many of `num_sweeps` were tracked, degraded, lost and not registered: as a warning if
/// most were lost or not registered.
void log_sweeps(const Metrics& metrics, std::size_t num_sweeps);

/// Warns if the laser is mounted other than described, and says what is to be changed.
void log_mount(const Slam6d& slam);

/// Counts of sweeps and scans, and the keyframes, each with its reason and the quality of its
/// registration.
[[nodiscard]] nlohmann::json slam_metrics(const Slam6d& slam);

}  // namespace nodmap::slam6d
