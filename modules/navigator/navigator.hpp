// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/geometry/se2.hpp"
#include "modules/navigator/approach.hpp"
#include "modules/navigator/brake.hpp"
#include "modules/navigator/corridor.hpp"
#include "modules/navigator/free_space.hpp"
#include "modules/navigator/goal.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/trail.hpp"
#include "modules/navigator/turn.hpp"
#include "modules/navigator/view.hpp"

namespace nodmap::navigator {

/// All that the navigator knows of a moment.
struct Situation {
  std::int64_t utime_us = 0;
  Points points_base;         ///< obstacles, now
  geometry::SE2 T_odom_base;  ///< now
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
  double max_forward_mps = 0.0;  ///< by the pitch controller
  std::int64_t sweep_count = 0;  ///< turns of the nod
  bool laser_is_held = false;    ///< it does not nod: nothing more is seen by waiting
  std::optional<GoalInBase> goal;
};

enum class Behaviour : std::uint8_t { kSteer, kBrake, kTurn, kArrived, kHalt };

/// What the robot is to do, and why.
struct Decision {
  Behaviour behaviour = Behaviour::kHalt;
  std::string reason;  ///< one sentence; empty where there is nothing to add
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
  double steering_angle_rad = 0.0;
  double free_way_m = 0.0;       ///< in the virtual corridor ahead; +infinity: nothing in it
  double max_forward_mps = 0.0;  ///< that the limits and the free way allow
};

/// Steer, Brake and Turn on the obstacle map (Holz et al. 2008, III C). One decision for each map:
///
///   Steer   alpha from the free space; drives the arc towards it, as fast as Brake allows
///   Brake   speed from the free way of the virtual corridor along that arc, 0 before an obstacle
///   Turn    once Brake stands: turns on the spot until the way ahead is free; stands while
///           something comes near
///
/// Whether the inputs may be used at all is decided before (staleness.hpp): then halt() is called
/// instead of decide().
class Navigator {
 public:
  explicit Navigator(const NavigatorParams& params);

  [[nodiscard]] Decision decide(const Situation& now);

  /// Stands. What was seen until now may have changed when it goes on: it looks again first.
  [[nodiscard]] Decision halt(std::string reason);

  /// The odom frame began anew: what was kept in it means nothing any more.
  void reset();

 private:
  /// An arc, and how far it is free.
  struct Arc {
    double curvature = 0.0;
    double way_m = 0.0;
    double speed_mps = 0.0;  ///< from which the robot stops in time on it
  };

  [[nodiscard]] FreeSpace trusted(const FreeSpace& space, const Situation& now) const;
  [[nodiscard]] FreeSpace steering_space(const FreeSpace& trusted_space,
                                         const Situation& now) const;
  [[nodiscard]] bool is_trusted(double direction_rad, const Situation& now) const;
  [[nodiscard]] std::optional<double> steering_direction(const FreeSpace& space,
                                                         const Situation& now);
  [[nodiscard]] std::optional<double> roaming_direction(const FreeSpace& space, double needed_m);
  [[nodiscard]] Arc measure_arc(double curvature, const Situation& now) const;
  [[nodiscard]] std::optional<Arc> arc_towards(double direction_rad, const Situation& now) const;
  [[nodiscard]] double speed_now_allowed(const Situation& now) const;
  [[nodiscard]] std::optional<Decision> steer(double direction_rad, const Situation& now) const;
  [[nodiscard]] Decision brake(const Situation& now, std::string reason) const;
  [[nodiscard]] Decision give_way(const Situation& now) const;
  [[nodiscard]] TurnView look_around(const FreeSpace& space, const FreeSpace& trusted_space,
                                     const Situation& now) const;
  [[nodiscard]] Decision turn(const FreeSpace& space, const FreeSpace& trusted_space,
                              const Situation& now);
  [[nodiscard]] Decision back_up(const Situation& now);
  void watch(const Situation& now);
  [[nodiscard]] double preferred_side(const Situation& now) const;

  NavigatorParams params_;
  Footprint body_;
  Trail trail_;
  View view_;
  Approach approach_;
  Turn turn_;
  Detour detour_;
  bool arrived_ = false;
  double roaming_side_ = 0.0;  ///< on which it goes round what is ahead; 0: nothing is
  std::optional<geometry::SE2> turn_ended_at_;     ///< T_odom_base
  std::optional<geometry::SE2> back_up_began_at_;  ///< T_odom_base
};

}  // namespace nodmap::navigator
