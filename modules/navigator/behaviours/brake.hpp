// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/navigator/behaviours/corridor.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/people/passive_safety.hpp"
#include "modules/navigator/situation.hpp"

namespace nodmap::navigator {

/// Slower than this the robot does not start to drive; it turns instead.
inline constexpr double kMinSpeedMps = 0.06;

/// An arc (curvature in 1/m, positive left): how far it is free, and how fast it may be driven.
struct Arc {
  double curvature = 0.0;
  double free_distance_m = 0.0;
  double stop_margin_m = 0.0;  ///< the part of this distance that is left after stopping
  double speed_mps = 0.0;      ///< the greatest from which the robot stops in time
};

/// The yaw rate from which a rotation on the spot stops within an angle, at most that of Turn.
[[nodiscard]] double rate_to_stop_within_rad_s(double angle_rad, const TurnParams& turn,
                                               const BaseParams& base, double reaction_s);

/// Brake (paper, III C): computes the greatest speed from which the robot stops before anything in
/// the virtual corridor along its arc; common/robot/stopping.hpp has the formula.
class Brake {
 public:
  /// `creeps`: passes obstacles within the side margin slowly, but not those within the creep
  /// margin.
  explicit Brake(const NavigatorParams& params, bool creeps = false)
      : creeps_(creeps),
        body_(params.robot.body.footprint()),
        braking_(params.robot.braking),
        drive_params_(params.drive),
        base_params_(params.base),
        local_map_params_(params.local_map),
        turn_params_(params.turn),
        passive_safety_(params) {}

  /// Measures an arc. Within the stopping distance, ground that was not seen blocks it as an
  /// obstacle does.
  [[nodiscard]] Arc measure_arc(double curvature, const Situation& now) const;

  /// The greatest safe speed on the robot's present arc, along which it would brake, whatever arc
  /// is chosen next. 0 if an obstacle is nearer than even an emergency stop needs; +infinity if the
  /// robot hardly moves. Below the creep speed the margins of a creeping robot suffice.
  [[nodiscard]] double speed_on_present_arc(const Situation& now) const;

  /// A stop that nothing demands: with ordinary brakes along the present arc, and as fast as that
  /// arc requires. A robot that hardly moves stops at once.
  [[nodiscard]] Decision slow_down(Reason reason, const Situation& now) const;

  /// Drives an arc, which leads in `direction_rad`, as fast as is safe, but at most at `limit_mps`,
  /// and stops at the goal.
  [[nodiscard]] Decision drive(const Arc& arc, double direction_rad, double limit_mps,
                               const Situation& now) const;

  /// Slows down a rotation, or an arc that swings the rear aside, over ground that is not known to
  /// be free, until the corners are so slow that they count as stationary.
  void keep_to_known_ground(Decision& decision, const Situation& now) const;

  /// Slows any motion down so far that, with ordinary brakes, the robot is stationary before a
  /// walking person touches it; to 0 if from the present motion only an emergency stop may suffice,
  /// or not even that. One motion is left as it is: the one
  /// that takes the robot out of the way of a person who would otherwise walk into it.
  void give_way(Decision& decision, const Situation& now) const;

  /// The speed that yaw rate and lateral acceleration allow on an arc, at most `max_forward_mps`:
  /// |v curvature| <= yaw rate and v |v curvature| <= lateral acceleration.
  [[nodiscard]] double speed_limit(double curvature, double max_forward_mps) const;

  /// The speed from which the robot stops within a distance, without any margin.
  [[nodiscard]] double stoppable_mps(double distance_m) const;
  /// The inverse: the distance that an ordinary stop takes.
  [[nodiscard]] double stopping_m(double forward_mps) const;
  /// The same for a rotation on the spot.
  [[nodiscard]] double stoppable_rad_s(double angle_rad) const;

 private:
  [[nodiscard]] Arc measure_arc(double curvature, bool creeps, const Situation& now) const;
  [[nodiscard]] Arc measure_corridor(double curvature, double side_margin_m, double stop_margin_m,
                                     const Situation& now) const;
  [[nodiscard]] double speed_before_ramps_down(double curvature, const Situation& now) const;
  /// At most `max_mps`.
  [[nodiscard]] double speed_on_seen_floor(double curvature, double max_mps,
                                           const Situation& now) const;

  bool creeps_;
  robot::Footprint body_;
  robot::Braking braking_;
  DriveParams drive_params_;
  BaseParams base_params_;
  LocalMapParams local_map_params_;
  TurnParams turn_params_;
  PassiveSafety passive_safety_;
};

}  // namespace nodmap::navigator
