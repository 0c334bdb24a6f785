// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/registration/pose_graph.hpp"
#include "modules/slam2d/back_end/loop_closer.hpp"
#include "modules/slam2d/back_end/submap.hpp"

namespace nodmap::slam2d {

/// All keyframes as nodes of a pose graph, for the final correction of their poses. Edges are the
/// measured step from each keyframe to the next, and new matches of each keyframe against the
/// submaps around it.
struct PolishGraph {
  std::span<const Keyframe> keyframes;
  std::span<const Submap> submaps;
  std::span<const registration::PoseEdge2d> chain;  ///< from keyframe k to k + 1

  /// The corrected T_map_base of each keyframe. Submaps within `max_distance_m` are matched.
  [[nodiscard]] std::vector<geometry::SE2> polished(const LoopCloser& closer,
                                                    double max_distance_m) const;

 private:
  [[nodiscard]] std::vector<registration::PoseEdge2d> matches(const LoopCloser& closer,
                                                              double max_distance_m) const;
};

}  // namespace nodmap::slam2d
