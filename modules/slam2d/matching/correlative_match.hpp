// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/slam2d/matching/likelihood_grid.hpp"
#include "modules/slam2d/scan/oriented_points.hpp"

namespace nodmap::slam2d {

/// The points of a scan that are worth searching with: at most one in each square of 0.2 m, no
/// farther than 25 m.
[[nodiscard]] std::vector<Eigen::Vector2d> points_to_search(std::span<const OrientedPoint> scan);

/// The poses to search, in `target`, the frame of the map that is searched: up to `distance_m` from
/// `T_target_base` in x and in y, and up to `rotation_rad` from its heading.
struct SearchWindow {
  geometry::SE2 T_target_base;
  double distance_m = 0.0;
  double rotation_rad = 0.0;
};

/// A pose at which a scan fits the map that was searched.
struct Peak {
  geometry::SE2 T_target_base;
  double score = 0.0;  ///< mean likelihood of the points, 0..1
};

struct CorrelativeMatch {
  /// The best pose first. Each further peak is the best pose that is not near an earlier peak.
  std::vector<Peak> peaks;
  bool complete = true;  ///< false: the search ended at its limit, and may have missed peaks

  /// Whether the best pose was found, and no other comes near its score.
  [[nodiscard]] bool is_unique() const { return complete && peaks.size() == 1; }
};

/// What a search returns.
struct SearchLimits {
  double min_score = 0.0;  ///< of each pose
  /// Poses that score less than this ratio of the best are left out.
  double min_peak_ratio = 0.0;
  std::size_t max_peaks = 2;
};

/// Finds the pose of a scan in a map without a good guess: the best of all poses in a window, one
/// cell apart and rotated in steps that move the farthest point by one cell (Olson 2009). Branch
/// and bound (Hess et al. 2016, section V-B) finds the same pose as trying all of them.
/// `points_base`: the points of the scan, in base.
[[nodiscard]] CorrelativeMatch match_in_window(const LikelihoodGrid& grid,
                                               std::span<const Eigen::Vector2d> points_base,
                                               const SearchWindow& window,
                                               const SearchLimits& limits);

/// The angle between neighbouring poses, in which the farthest point moves by one cell.
[[nodiscard]] double rotation_step_rad(std::span<const Eigen::Vector2d> points_base,
                                       double cell_size_m);

}  // namespace nodmap::slam2d
