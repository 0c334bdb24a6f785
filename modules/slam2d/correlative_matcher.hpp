// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/slam2d/likelihood_grid.hpp"
#include "modules/slam2d/oriented_points.hpp"
#include "modules/slam2d/params.hpp"

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
  /// Peaks that score less than `max_runner_up_ratio` of the best are left out.
  std::vector<Peak> peaks;
  bool complete = true;  ///< false: the search ended at its limit, and may have missed peaks

  /// Whether the best pose was found, and no other comes near its score.
  [[nodiscard]] bool is_unique() const { return complete && peaks.size() == 1; }
};

/// Finds the pose of a scan in a map without a good guess: the best of all poses in a window, one
/// cell apart and rotated in steps that move the farthest point by one cell (Olson 2009). Branch
/// and bound (Hess et al. 2016, section V-B) finds the same pose as trying all of them.
class CorrelativeMatcher {
 public:
  explicit CorrelativeMatcher(const LoopSearchParams& params) : params_(params) {}

  /// Returns the best poses in the window, at most `max_peaks`, each with a score of at least
  /// `min_score`. `points_base`: the points of the scan, in base.
  [[nodiscard]] CorrelativeMatch search(const LikelihoodGrid& grid,
                                        std::span<const Eigen::Vector2d> points_base,
                                        const SearchWindow& window,
                                        std::size_t max_peaks = 2) const;

  /// The angle between neighbouring poses, in which the farthest point moves by one cell.
  [[nodiscard]] static double rotation_step_rad(std::span<const Eigen::Vector2d> points_base,
                                                double cell_size_m);

 private:
  LoopSearchParams params_;
};

}  // namespace nodmap::slam2d
