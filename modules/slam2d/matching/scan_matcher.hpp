// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "common/registration/normal_equations.hpp"
#include "modules/slam2d/matching/point_map.hpp"
#include "modules/slam2d/params.hpp"

namespace nodmap::slam2d {

/// The result of matching a scan with a map. `target` is the frame of that map: of a submap or of a
/// known map.
struct Match {
  geometry::SE2 T_target_base;
  double inlier_ratio = 0.0;  ///< fraction of the scan points with a correspondence
  double score = 0.0;         ///< mean weight w_ij of all scan points, 0 (none near the map) to 1
  double rms_m = 0.0;         ///< weighted distance of the correspondences
  int degenerate_directions = 3;  ///< of x, y, yaw, left at the guess; 3: nothing was matched
  /// The least information on any direction, as a ratio of what the correspondences could give.
  double least_information_ratio = 0.0;
  int iterations = 0;
  /// Inverse covariance of (x, y in m, yaw in rad) in `target`; zero along degenerate
  /// directions.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();

  [[nodiscard]] bool found() const { return degenerate_directions < 3; }
};

/// Matches a level scan against a map by ICP (section IV A).
class ScanMatcher {
 public:
  explicit ScanMatcher(const MatcherParams& params) : params_(params) {}

  /// Finds the pose of a scan (points in base), starting at `T_target_base_guess`, the pose by
  /// odometry. Along degenerate directions the pose stays at the guess; with fewer than 10
  /// correspondences it stays there altogether.
  [[nodiscard]] Match match(const PointMap& map, std::span<const OrientedPoint> scan,
                            const geometry::SE2& T_target_base_guess) const;

 private:
  struct Correspondences;
  /// What the searches for the points of a scan remember. Affects only the speed.
  struct Remembered {
    std::vector<Neighbourhood> around;  // of each scan point
    PointMap::Block block;
  };
  [[nodiscard]] Correspondences find_correspondences(const PointMap& map,
                                                     std::span<const OrientedPoint> scan,
                                                     const geometry::SE2& T_target_base,
                                                     double max_distance_m,
                                                     Remembered& remembered) const;
  /// Whether distances to lines are minimised, for this maximum correspondence distance.
  [[nodiscard]] bool uses_lines(double max_distance_m) const;
  /// The distance to which the maximum correspondence distance shrinks.
  [[nodiscard]] double last_distance_m() const;
  [[nodiscard]] Eigen::Vector3d step(const Correspondences& correspondences,
                                     const registration::NormalEquations::Solution& lines,
                                     const geometry::SE2& T_target_base,
                                     double max_distance_m) const;
  void evaluate(const PointMap& map, std::span<const OrientedPoint> scan, Remembered& remembered,
                Match& match) const;

  MatcherParams params_;
};

}  // namespace nodmap::slam2d
