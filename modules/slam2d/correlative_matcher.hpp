// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/slam2d/params.hpp"

namespace nodmap::slam2d {

/// How likely a point is measured in each cell of a map, and for each power of two w the largest
/// value in the window of w x w cells that begins at each cell: the upper bounds of a
/// branch-and-bound search (Hess et al. 2016, section V-B).
class LikelihoodGrid {
 public:
  /// 2^(kLevels - 1) cells are the widest window.
  static constexpr int kLevels = 6;

  /// `points`: of walls and objects. What is not finite or farther than `max_range_m` from the
  /// mean of the points is left out.
  LikelihoodGrid(std::span<const Eigen::Vector2d> points, double cell_size_m, double max_range_m);

  [[nodiscard]] double cell_size_m() const { return cell_size_m_; }
  /// The cell that a coordinate lies in, relative to the first of the grid.
  [[nodiscard]] Eigen::Vector2i cell_of(const Eigen::Vector2d& p) const;
  /// The largest likelihood, 0..255, in the window of 2^level cells that begins at a cell.
  [[nodiscard]] int largest(int level, int x, int y) const {
    const bool inside = x >= 0 && y >= 0 && x < width_ && y < height_;
    return inside ? levels_[static_cast<std::size_t>(level)]
                           [static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                            static_cast<std::size_t>(x)]
                  : 0;
  }

 private:
  void stamp(const Eigen::Vector2d& p);
  void add_level();

  double cell_size_m_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int width_ = 0;
  int height_ = 0;
  std::vector<std::vector<std::uint8_t>> levels_;  // row by row, x fastest
};

/// The poses to search: all in a square around the middle, up to `distance_m` in x and in y, and up
/// to `rotation_rad` from its heading.
struct SearchWindow {
  geometry::SE2 T_map_base;
  double distance_m = 0.0;
  double rotation_rad = 0.0;
};

struct CorrelativeMatch {
  geometry::SE2 T_map_base;
  double score = 0.0;  ///< mean likelihood of the points, 0..1
  /// Of the best pose that is no neighbour of this one; an upper bound of it where it is below
  /// what was asked for.
  double runner_up_score = 0.0;
  /// Of (x, y in m, yaw in rad): the spread of the scores around the best pose (Olson 2009).
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::size_t expanded = 0;  ///< nodes of the search, for its cost
  bool complete = true;      ///< false: the search ended at its limit, and found nothing
};

/// Finds the pose of a scan in a map without a good guess: the best of all poses in a window, one
/// cell apart and rotated in steps that move the farthest point by one cell (Olson 2009). Branch
/// and bound finds the same pose as looking at each of them.
class CorrelativeMatcher {
 public:
  explicit CorrelativeMatcher(const LoopSearchParams& params) : params_(params) {}

  /// The points of a scan, in base. A score below `min_score` means that nothing was found.
  [[nodiscard]] CorrelativeMatch search(const LikelihoodGrid& grid,
                                        std::span<const Eigen::Vector2d> points_base,
                                        const SearchWindow& window) const;

  /// The step from one rotated pose to the next, for these points.
  [[nodiscard]] static double rotation_step_rad(std::span<const Eigen::Vector2d> points_base,
                                                double cell_size_m);

 private:
  LoopSearchParams params_;
};

}  // namespace nodmap::slam2d
