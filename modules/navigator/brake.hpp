// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/navigator/corridor.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/people/passive_safety.hpp"

namespace nodmap::navigator {

/// Slower than this the robot does not start to drive; it turns instead.
inline constexpr double kLeastSpeedMps = 0.06;

/// An arc (curvature in 1/m, positive left) and how far it is free.
struct Arc {
  double curvature = 0.0;
  double free_distance_m = 0.0;
  double stop_margin_m = 0.0;  ///< of that is left when the robot has stopped
  double speed_mps = 0.0;      ///< from which the robot stops in time on it
};

/// Brake (paper, III C): the speed from which the robot stops before what is in the virtual
/// corridor along its arc; common/robot/stopping.hpp has the formula.
class Brake {
 public:
  /// `creeps`: it passes slowly what is within the side margin, but not within the creep margin.
  explicit Brake(const NavigatorParams& params, bool creeps = false)
      : creeps_(creeps),
        body_(params.robot.body.footprint()),
        braking_(params.robot.braking),
        drive_(params.drive),
        local_map_(params.local_map),
        turn_(params.turn),
        passive_safety_(params.robot, params.drive, params.people) {}

  /// Within the stopping distance what was not seen blocks, as an obstacle does.
  [[nodiscard]] Arc measure_arc(double curvature, const Situation& now) const;

  /// What the arc allows that the robot is on now, for on that it would brake. 0 when it is nearer
  /// to an obstacle than even an emergency stop needs; +infinity while it is hardly moving.
  [[nodiscard]] double speed_on_present_arc(const Situation& now) const;

  /// Slows a rotation down, and an arc that swings the body's rear aside, over ground that is not
  /// known to be free: to so slow a rotation that the corners count as stationary.
  void keep_to_known_ground(Decision& decision, const Situation& now) const;

  /// Slows a motion down, on whatever path, so far that the robot is stationary before anyone who
  /// walks touches it; to 0 where the motion that it is in is not safe any more. Not where he would
  /// walk into the standing robot, and the motion gets it out of his way.
  void give_way(Decision& decision, const Situation& now) const;

  /// The speed that yaw rate and lateral acceleration allow on an arc, at most `max_forward_mps`:
  /// |v curvature| <= yaw rate and v |v curvature| <= lateral acceleration.
  [[nodiscard]] double speed_limit(double curvature, double max_forward_mps) const;

  /// The speed from which the robot stops within a distance, without any margin.
  [[nodiscard]] double stoppable_mps(double distance_m) const;

 private:
  [[nodiscard]] Arc measure_corridor(double curvature, double side_margin_m, double stop_margin_m,
                                     const Situation& now) const;
  /// At most `max_mps`.
  [[nodiscard]] double speed_on_seen_floor(double curvature, double max_mps,
                                           const Situation& now) const;

  bool creeps_;
  Footprint body_;
  robot::Braking braking_;
  DriveParams drive_;
  LocalMapParams local_map_;
  TurnParams turn_;
  PassiveSafety passive_safety_;
};

}  // namespace nodmap::navigator
