// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/registration/pose_graph.hpp"
#include "modules/slam6d/back_end/keyframe.hpp"
#include "modules/slam6d/back_end/plane_adjustment.hpp"
#include "modules/slam6d/params.hpp"
#include "modules/slam6d/tracking/corrected_poses.hpp"
#include "modules/slam6d/tracking/tracker.hpp"

namespace nodmap::slam6d {

/// Everything that was tracked in a drive.
struct TrackedDrive {
  std::span<const Keyframe> keyframes;
  std::span<const IntermediateSweep> between;
  const CorrectedPoses& poses;
  std::span<const registration::PoseEdge3d> steps;  ///< from keyframe to keyframe
};

/// The sweeps that are adjusted, in order of time: keyframes and those in between.
struct AdjustedDrive {
  std::vector<AdjustedSweep> sweeps;
  std::vector<std::size_t> places;  ///< the numbers of these sweeps
};

/// The input of adjust_planes(): of each sweep its points, the motion since the keyframe before
/// with its covariance, and whether its ground is level. The motion combines calibrated odometry
/// with the matches with the map: where two keyframes have few planes in common, as through a door,
/// odometry alone would pull them apart by centimetres.
[[nodiscard]] AdjustedDrive adjusted_sweeps(const TrackedDrive& drive, const Tracker& tracker,
                                            const Slam6dParams& params);

/// Where everything is after the adjustment.
struct AdjustedPoses {
  std::vector<geometry::SE3> T_map_keyframes;
  std::vector<CorrectedPoses::Correction> sweeps;  ///< in order of time, keyframes included
};

/// Adjusts keyframes and the sweeps in between together: adjust_planes() of adjusted_sweeps().
[[nodiscard]] AdjustedPoses adjusted_poses(const TrackedDrive& drive, const Tracker& tracker,
                                           const Slam6dParams& params);

}  // namespace nodmap::slam6d
