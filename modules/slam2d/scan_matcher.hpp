// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "modules/slam2d/normal_equations.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/point_map.hpp"
#include "modules/slam2d/rigid_fit.hpp"

namespace nodmap::slam2d {

/// How a scan fits the map.
struct Match {
  geometry::SE2 T_map_base;
  int pairs = 0;            ///< scan points with a correspondence at the end
  double share = 0.0;       ///< of all scan points, 0..1
  double agreement = 0.0;   ///< mean weight over all scan points: 1 all on the map, 0 none near it
  double rms_m = 0.0;       ///< weighted distance of the pairs
  int weak_directions = 3;  ///< of x, y, yaw: left at the start pose; 3: nothing was matched
  int iterations = 0;
  /// Inverse covariance of (x, y in m, yaw in rad) in the frame of the map; none along directions
  /// the scene leaves open.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();

  [[nodiscard]] bool found() const { return weak_directions < 3; }
};

/// ICP of a level scan against the map (section IV A).
class ScanMatcher {
 public:
  explicit ScanMatcher(const Slam2dParams& params) : params_(params) {}

  /// From `T_map_base_guess`, the pose by odometry. Directions the scene leaves open stay there.
  [[nodiscard]] Match match(const PointMap& map, std::span<const SurfacePoint> scan,
                            const geometry::SE2& T_map_base_guess) const;

 private:
  struct Evidence;
  [[nodiscard]] static Evidence find_pairs(const PointMap& map, std::span<const SurfacePoint> scan,
                                           const geometry::SE2& T_map_base, double gate_m);
  [[nodiscard]] Eigen::Vector3d step(const Evidence& evidence, const geometry::SE2& T_map_base,
                                     double gate_m) const;

  void judge(const PointMap& map, std::span<const SurfacePoint> scan, Match& match) const;

  Slam2dParams params_;
};

}  // namespace nodmap::slam2d
