// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "modules/slam2d/params.hpp"
#include "modules/slam2d/point_map.hpp"

namespace nodmap::slam2d {

/// Start poses for ICP where the one by odometry does not lead to a match: a slipping wheel, a gap
/// in the recording, a robot that was carried.
class PoseSearch {
 public:
  explicit PoseSearch(const Slam2dParams& params) : params_(params) {}

  /// The most promising poses around `T_map_base_guess`, best first, all clearly different.
  [[nodiscard]] std::vector<geometry::SE2> candidates(const PointMap& map,
                                                      std::span<const SurfacePoint> scan,
                                                      const geometry::SE2& T_map_base_guess) const;

  /// How far a pose is from the guess: 0 there, 1 at a quarter turn or two search distances.
  [[nodiscard]] double departure(const geometry::SE2& pose, const geometry::SE2& guess) const;

 private:
  Slam2dParams params_;
};

}  // namespace nodmap::slam2d
