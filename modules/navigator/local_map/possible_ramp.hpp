// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "modules/navigator/ground/plane.hpp"
#include "modules/navigator/ground/tracked_ground.hpp"
#include "modules/navigator/local_map/local_cell.hpp"
#include "modules/navigator/params.hpp"

namespace nodmap::navigator {

/// Decides whether something that was measured beside the known ground could be a ramp that is not
/// known yet. Such a place stays unknown until the laser has seen it from nearer; Brake stops
/// before it. A view of the map at one moment.
class PossibleRamp {
 public:
  PossibleRamp(const LocalGrid& grid, const TrackedGround& ground, const LocalMapParams& params,
               const Eigen::Vector2d& robot_odom)
      : grid_(grid), ground_(ground), params_(params), robot_odom_(robot_odom) {}

  /// Whether a point, `height_m` above the known ground, could be on a ramp that begins behind the
  /// last floor seen before it. `tolerance_m`: of heights at that distance. Only points far away
  /// could: from nearer a ramp is known as one. And only near slopes: on level floor the robot is
  /// fast, and the narrow nod has a low sill in view for a short time only, so everything there is
  /// an obstacle at once.
  [[nodiscard]] bool leads_up(const Eigen::Vector3d& p_odom, double height_m,
                              double tolerance_m) const {
    return !ground_.is_level() && could_lead_up(p_odom, height_m, tolerance_m);
  }
  /// The same on level ground as well: what is an obstacle to the robot, but should be looked at
  /// from nearer before a plan leads elsewhere.
  [[nodiscard]] bool could_lead_up(const Eigen::Vector3d& p_odom, double height_m,
                                   double tolerance_m) const;

  /// The same of an obstacle that is at most `high_cm` (odom) high, if something higher rises
  /// behind it: a sill is no ramp.
  [[nodiscard]] bool could_be(const Eigen::Vector2d& p_odom, std::int16_t high_cm,
                              double tolerance_m) const;

  /// Whether a ramp could lead down to a point from the last floor seen before the place where the
  /// beam passed down through `plane`, the ground that is known there. It could, unless the beam
  /// looked down more steeply than the steepest ramp. `tolerance_m`: of heights at the point's
  /// distance.
  [[nodiscard]] bool leads_down(const Eigen::Vector3d& p_odom, const Eigen::Vector2d& crossing_odom,
                                const Plane& plane, double tolerance_m) const;

 private:
  [[nodiscard]] bool rises_behind(const Eigen::Vector2d& p_odom, std::int16_t high_cm) const;
  [[nodiscard]] Eigen::Vector2d last_floor_before(const Eigen::Vector2d& p_odom,
                                                  double farthest_m) const;

  const LocalGrid& grid_;
  const TrackedGround& ground_;
  const LocalMapParams& params_;
  Eigen::Vector2d robot_odom_;
};

}  // namespace nodmap::navigator
