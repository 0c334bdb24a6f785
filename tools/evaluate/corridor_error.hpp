// SPDX-License-Identifier: BSD-3-Clause
// How a map of a corridor is bent, stretched and turned, from the way driven through it.
#pragma once

#include <optional>
#include <vector>

#include "tools/evaluate/trajectory_error.hpp"

namespace nodmap::evaluate {

/// All in the ground plane, with the first pose of both trajectories laid on each other.
struct CorridorErrors {
  double length_m = 0.0;           ///< true way along the corridor's axis, from first to last pose
  double length_error_m = 0.0;     ///< of the estimated one, signed: positive is too long
  double bow_m = 0.0;              ///< largest error across the axis, of all poses
  double heading_error_rad = 0.0;  ///< largest error of the heading, of all poses
};

/// The axis leads from the first to the last true position. A map is as long, as bent and as
/// turned as the poses from which its scans were entered, so that these are judged: the bow
/// includes what a wrong first heading or a slow drift moves the far end aside. Empty without
/// pairs, or when the true way leads nowhere (shorter than 1 m), for then there is no axis.
[[nodiscard]] std::optional<CorridorErrors> measure_corridor(const std::vector<PosePair>& pairs);

}  // namespace nodmap::evaluate
