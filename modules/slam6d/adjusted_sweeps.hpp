// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "common/registration/pose_graph.hpp"
#include "modules/slam6d/keyframe.hpp"
#include "modules/slam6d/params.hpp"
#include "modules/slam6d/plane_adjustment.hpp"
#include "modules/slam6d/pose_update.hpp"
#include "modules/slam6d/tracker.hpp"

namespace nodmap::slam6d {

/// The input of adjust_planes() for each keyframe: its voxels, the motion since the keyframe before
/// with its covariance, and whether its ground is level. The motion combines calibrated odometry
/// with the matches with the map (`steps` of the pose graph): where two keyframes have few planes
/// in common, as through a door, odometry alone would pull them apart by centimetres. `updates`: of
/// all sweeps.
[[nodiscard]] std::vector<AdjustedSweep> adjusted_sweeps(
    std::span<const Keyframe> keyframes, std::span<const PoseUpdate> updates,
    std::span<const registration::PoseEdge3d> steps, const Tracker& tracker,
    const Slam6dParams& params);

}  // namespace nodmap::slam6d
