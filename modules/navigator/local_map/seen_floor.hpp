// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/robot/footprint.hpp"
#include "modules/navigator/local_map/local_cell.hpp"
#include "modules/navigator/local_map/obstacle_memory.hpp"

namespace nodmap::navigator {

/// The floor of the local map that was seen, and how far the body can move over it. A view of the
/// map, valid until it changes.
class SeenFloor {
 public:
  /// The laser does not see floor nearer to base than `blind_m`.
  SeenFloor(const LocalGrid& grid, const ObstacleMemory& obstacles, const robot::Footprint& body,
            double blind_m)
      : grid_(grid), obstacles_(obstacles), body_(body), blind_m_(blind_m) {}

  /// How far the robot can drive along an arc (curvature in 1/m, positive left), at most `max_m`,
  /// until floor that was not seen is so near that the laser cannot look down at it any more. Floor
  /// was not seen where a gap between seen places is longer than `max_gap_m` along the arc: a hole
  /// of that length would have had a beam in it. The floor must be as wide as the body's front.
  /// With `ends_at_obstacles` no floor is required behind an obstacle that is hardly farther away
  /// than the nearest floor that the laser sees, because the obstacle hides it.
  [[nodiscard]] double distance(const geometry::SE2& T_odom_base, double curvature, double max_m,
                                double max_gap_m, bool ends_at_obstacles = false) const;
  /// The same for the body's rear, driving backwards. Here the ground on which the robot was set
  /// down does not count as seen.
  [[nodiscard]] double distance_backwards(const geometry::SE2& T_odom_base, double curvature,
                                          double max_m) const;

  /// Whether there is floor in a cell, or so near to it that nothing fits in between. The ground on
  /// which the robot was set down counts.
  [[nodiscard]] bool is_near(const Eigen::Vector2i& index) const;
  /// Whether floor was seen at a place and around it, whatever is there now. At the foot of
  /// something that has always been there, half of the cells around were never floor.
  [[nodiscard]] bool is_around(const Eigen::Vector2d& p_odom) const;

 private:
  /// A row of places across the body, as the middle of its front passes there.
  struct Row {
    double s_m;  ///< along the arc, from where the laser sees floor
    Eigen::Vector2d middle_odom;
    Eigen::Vector2d left_odom;  ///< unit vector
  };

  [[nodiscard]] double distance_in_column(const std::vector<Row>& rows, double left_m,
                                          double max_gap_m, bool ends_at_obstacles) const;
  [[nodiscard]] bool is_row_seen(const geometry::SE2& T_odom_row) const;

  const LocalGrid& grid_;
  const ObstacleMemory& obstacles_;
  robot::Footprint body_;
  double blind_m_;
};

}  // namespace nodmap::navigator
