// SPDX-License-Identifier: BSD-3-Clause
// The errors of a map of a corridor (bend, length, rotation), from the trajectory through it.
#pragma once

#include <optional>
#include <vector>

#include "tools/evaluate/trajectory_error.hpp"

namespace nodmap::evaluate {

/// All in the ground plane, with the first poses of both trajectories aligned.
struct CorridorErrors {
  double length_m = 0.0;  ///< true distance along the corridor's axis, from first to last pose
  double length_error_m = 0.0;     ///< error of the estimated length; positive: too long
  double bow_m = 0.0;              ///< largest error across the axis, of all poses
  double heading_error_rad = 0.0;  ///< largest error of the heading, of all poses
};

/// The axis leads from the first to the last true position. A map has the errors of the poses at
/// which its scans were entered, so these poses are measured. The bow includes the sideways error
/// of the far end caused by a wrong first heading or a slow drift. Empty without pairs, or if the
/// true path is too short (1 m) to define an axis.
[[nodiscard]] std::optional<CorridorErrors> measure_corridor(const std::vector<PosePair>& pairs);

}  // namespace nodmap::evaluate
