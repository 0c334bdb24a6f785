// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "modules/slam6d/registration/registration.hpp"

namespace nodmap::slam6d {

/// What 6D SLAM has counted and measured so far.
struct Metrics {
  std::size_t sweeps_tracked = 0;
  std::size_t sweeps_degraded = 0;
  std::size_t sweeps_lost = 0;
  std::size_t sweeps_unused = 0;  ///< not registered: cut short, too few planes, place unknown
  std::size_t map_voxels = 0;
  std::size_t map_memory_bytes = 0;
  std::size_t keyframe_memory_bytes = 0;  ///< of their clouds, and of the sweeps in between

  void count(PoseState state) {
    sweeps_tracked += state == PoseState::kTracking ? 1 : 0;
    sweeps_degraded += state == PoseState::kDegraded ? 1 : 0;
    sweeps_lost += state == PoseState::kLost ? 1 : 0;
  }
  /// So many of the unused sweeps had been registered, before the map began again.
  void count_tracked_before(std::size_t num_sweeps) {
    sweeps_unused -= num_sweeps;
    sweeps_tracked += num_sweeps;
  }
};

}  // namespace nodmap::slam6d
