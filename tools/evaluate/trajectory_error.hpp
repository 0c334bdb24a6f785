// SPDX-License-Identifier: BSD-3-Clause
// The errors of a trajectory compared with the true one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/formats/tum.hpp"
#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::evaluate {

/// The estimated and the true pose at one time.
struct PosePair {
  geometry::SE3 T_map_base = geometry::SE3::Identity();    ///< estimated, in its own frame
  geometry::SE3 T_truth_base = geometry::SE3::Identity();  ///< true
  double true_path_m = 0.0;                                ///< from the first true pose to here
};

/// Pairs each estimated pose with the true pose at its time, interpolated between the two nearest
/// samples. Omits poses without a true sample within `tolerance`. The truth may be in any order; if
/// it contains a stamp more than once, the first counts.
[[nodiscard]] std::vector<PosePair> associate(const formats::Trajectory& estimate,
                                              formats::Trajectory truth, time::Duration tolerance);

/// The longest time of the true path without an estimated pose, seconds: a process that gives no
/// pose where it is difficult has a small error but a long gap. `truth` must not be empty.
[[nodiscard]] double longest_gap_s(const formats::Trajectory& estimate,
                                   const formats::Trajectory& truth);

enum class Alignment : std::uint8_t {
  kFirstPose,   ///< the first pair agrees, as for a robot that starts at a known pose
  kMinSquares,  ///< all positions agree in the least-squares sense (Umeyama 1991, no scale)
};

struct TrajectoryErrors {
  std::size_t n = 0;
  double ate_rmse_m = 0.0;
  double ate_max_m = 0.0;
  double rot_rmse_rad = 0.0;
  /// Error of the last pose after alignment of the first, independent of the alignment of the rest.
  double end_error_m = 0.0;
  double end_rot_rad = 0.0;
  /// end_error_m in percent of the length of the true path from the first pair to the last, however
  /// few poses there are on it. Empty for a path without length.
  std::optional<double> drift_percent;
};

/// All errors are zero if there are no pairs.
[[nodiscard]] TrajectoryErrors measure_trajectory(const std::vector<PosePair>& pairs,
                                                  Alignment alignment);

}  // namespace nodmap::evaluate
