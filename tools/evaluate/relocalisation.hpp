// SPDX-License-Identifier: BSD-3-Clause
// How often nodmap-slam2d finds its pose in a map without a pose guess.
#pragma once

#include <cstddef>
#include <filesystem>

#include "common/formats/tum.hpp"

namespace nodmap::evaluate {

struct RelocalisationPlan {
  int num_scans = 1;  ///< number of successive level scans that are matched together, as a group
  int every = 0;      ///< use every n-th group; 0: about 200 groups in total
};

struct RelocalisationResult {
  std::size_t n = 0;
  std::size_t right = 0;      ///< within 0.25 m and 3 degrees of the truth
  std::size_t wrong = 0;      ///< reported at a wrong pose
  std::size_t said_lost = 0;  ///< reported as lost: fits nowhere, or at several places
  double ms_p50 = 0.0;        ///< processor time for one group
  double ms_max = 0.0;
};

/// Finds the poses of groups of successive level scans of a log in a map, each without a pose
/// guess, and compares them with the true poses, in the frame of the map, at the time of each
/// group's last scan. Omits groups whose true pose is not known within 50 ms. Throws
/// std::runtime_error for files that cannot be read.
[[nodiscard]] RelocalisationResult measure_relocalisation(const std::filesystem::path& map,
                                                          const std::filesystem::path& log,
                                                          const formats::Trajectory& truth,
                                                          const RelocalisationPlan& plan);

}  // namespace nodmap::evaluate
