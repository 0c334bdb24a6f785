// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "modules/navigator/ground/tracked_ground.hpp"
#include "modules/navigator/local_map/local_cell.hpp"
#include "modules/navigator/params.hpp"

namespace nodmap::navigator {

/// Decides whether something that was measured beside the known ground could be a ramp that is not
/// known yet. Such a place is unknown until the laser has seen it from nearer; the robot stops
/// before unknown ground (SeenFloor). A view of the map at one moment.
class PossibleRamp {
 public:
  PossibleRamp(const LocalGrid& grid, const TrackedGround& ground, const LocalMapParams& params,
               const Eigen::Vector2d& robot_odom)
      : grid_(grid), ground_(ground), params_(params), robot_odom_(robot_odom) {}

  /// Whether a point far away, `height_m` above the known ground, could be on a ramp that begins
  /// behind the last floor seen before it. From nearer a ramp is known as one, and everything else
  /// is an obstacle. So it is at once on level floor, where the robot is fast: a low sill is in
  /// view of the narrow nod for a short time only. `tolerance_m`: of heights at that distance.
  [[nodiscard]] bool leads_up(const Eigen::Vector3d& p_odom, double height_m,
                              double tolerance_m) const;

  /// Whether ground could lead down to a point from the last floor that was seen before the place
  /// where the beam passed below it: the laser has to look down there more steeply than the
  /// steepest ramp.
  [[nodiscard]] bool leads_down(const Eigen::Vector3d& p_odom,
                                const Eigen::Vector2d& crossing_odom) const;

 private:
  [[nodiscard]] Eigen::Vector2d last_floor_before(const Eigen::Vector2d& p_odom,
                                                  double farthest_m) const;

  const LocalGrid& grid_;
  const TrackedGround& ground_;
  const LocalMapParams& params_;
  Eigen::Vector2d robot_odom_;
};

}  // namespace nodmap::navigator
