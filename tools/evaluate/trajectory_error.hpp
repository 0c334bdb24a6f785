// SPDX-License-Identifier: BSD-3-Clause
// How far a trajectory is from the true one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/formats/tum.hpp"
#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::evaluate {

/// One time at which both trajectories are known.
struct PosePair {
  geometry::SE3 T_map_base = geometry::SE3::Identity();    ///< estimated, in a frame of its own
  geometry::SE3 T_truth_base = geometry::SE3::Identity();  ///< true
};

/// Pairs each estimated pose with the true one of its time, interpolated between the two samples
/// around it. Poses without a true sample within `tolerance` get no partner. The truth may come
/// in any order; where it has a stamp more than once, the first counts.
[[nodiscard]] std::vector<PosePair> associate(const formats::Trajectory& estimate,
                                              formats::Trajectory truth, time::Duration tolerance);

enum class Alignment : std::uint8_t {
  kFirstPose,     ///< the first pair agrees: what a robot that starts at a known place gets
  kLeastSquares,  ///< all positions agree as well as they can (Umeyama 1991, no scale)
};

struct TrajectoryErrors {
  std::size_t n = 0;
  double ate_rmse_m = 0.0;
  double ate_max_m = 0.0;
  double rot_rmse_rad = 0.0;
  /// Error of the last pose after alignment by the first, whatever the alignment of the rest.
  double end_error_m = 0.0;
  double end_rot_rad = 0.0;
  /// end_error_m in percent of the true path's length. Empty for a path without length.
  std::optional<double> drift_percent;
};

/// All errors are zero when there are no pairs.
[[nodiscard]] TrajectoryErrors measure_trajectory(const std::vector<PosePair>& pairs,
                                                  Alignment alignment);

}  // namespace nodmap::evaluate
