// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "common/registration/pose_graph.hpp"
#include "modules/slam2d/back_end/keyframe.hpp"
#include "modules/slam2d/back_end/variance_factor.hpp"
#include "modules/slam2d/cleared_region.hpp"

namespace nodmap::slam2d {

/// All that is needed to continue a map: its keyframes, and how they are joined.
struct SavedMap {
  /// A submap is made of consecutive keyframes.
  struct Submap {
    std::size_t first_keyframe = 0;
    std::size_t end_keyframe = 0;  ///< one past the last
  };
  /// All accepted loops between two submaps, combined.
  struct Loop {
    registration::PoseEdge2d edge;  ///< its nodes are submaps
    double score = 0.0;             ///< of the last match, 0..1
  };

  std::vector<Keyframe> keyframes;
  std::vector<registration::PoseEdge2d> steps;  ///< from keyframe k to k + 1
  std::vector<Submap> submaps;
  std::vector<Loop> loops;
  VarianceFactor variance_factor;  ///< as the loops have shown, also those of dropped submaps
  std::vector<ClearedRegion> cleared;
};

}  // namespace nodmap::slam2d
