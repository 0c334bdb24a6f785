// SPDX-License-Identifier: BSD-3-Clause
// How often nodmap-slam2d finds its place in a map from nothing.
#pragma once

#include <cstddef>
#include <filesystem>

#include "common/formats/tum.hpp"

namespace nodmap::evaluate {

struct RelocalisationPlan {
  int num_scans = 1;  ///< successive level scans that are placed together, as a group
  int every = 0;      ///< each such group is placed; 0: as many as give about 200
};

struct RelocalisationResult {
  std::size_t n = 0;
  std::size_t right = 0;      ///< within 0.25 m and 3 degrees of the truth
  std::size_t wrong = 0;      ///< said to be elsewhere
  std::size_t said_lost = 0;  ///< fits nowhere, or several places
  double ms_p50 = 0.0;        ///< of processor time for one group
  double ms_max = 0.0;
};

/// Places groups of successive level scans of a log in a map, each without any guess, and compares
/// with the true poses, in the frame of the map, at the time of the last scan of each. Groups whose
/// true pose is not known within 50 ms are left out. Throws std::runtime_error for files that
/// cannot be read.
[[nodiscard]] RelocalisationResult measure_relocalisation(const std::filesystem::path& map,
                                                          const std::filesystem::path& log,
                                                          const formats::Trajectory& truth,
                                                          const RelocalisationPlan& plan);

}  // namespace nodmap::evaluate
