// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/robot/footprint.hpp"
#include "modules/navigator/local_map/local_cell.hpp"
#include "modules/navigator/local_map/obstacle_memory.hpp"

namespace nodmap::navigator {

/// Says how far the body can move over floor that was seen. A view of the map at one moment.
class SeenFloor {
 public:
  /// The laser does not see floor nearer to base than `blind_m`.
  SeenFloor(const LocalGrid& grid, const ObstacleMemory& obstacles, const robot::Footprint& body,
            double blind_m)
      : grid_(grid), obstacles_(obstacles), body_(body), blind_m_(blind_m) {}

  /// See LocalMap::seen_distance() and seen_distance_backwards().
  [[nodiscard]] double distance(const geometry::SE2& T_odom_base, double curvature, double max_m,
                                double max_gap_m, bool ends_at_obstacles) const;
  [[nodiscard]] double distance_backwards(const geometry::SE2& T_odom_base, double curvature,
                                          double max_m) const;

  /// Whether there is floor in a cell, or so near to it that nothing fits in between.
  [[nodiscard]] bool is_near(const Eigen::Vector2i& index) const;
  /// See LocalMap::was_floor().
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
