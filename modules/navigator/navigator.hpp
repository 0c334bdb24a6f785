// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/time.hpp"
#include "modules/navigator/behaviours/back_up.hpp"
#include "modules/navigator/behaviours/brake.hpp"
#include "modules/navigator/behaviours/steering.hpp"
#include "modules/navigator/behaviours/turn.hpp"
#include "modules/navigator/contact/leave_contact.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/planner/goal_drive.hpp"
#include "modules/navigator/planner/roaming.hpp"
#include "modules/navigator/situation.hpp"
#include "modules/navigator/surroundings/surroundings.hpp"
#include "modules/navigator/trail.hpp"

namespace nodmap::navigator {

/// Steer, Brake and Turn on the obstacle map (Holz et al. 2008, III C). One decision for each map:
///
///   - Steer: direction alpha from the free space; drives the arc towards it.
///   - Brake: speed from the free distance in the virtual corridor along that arc.
///   - Turn, once Brake has stopped the robot: rotates on the spot until the direction ahead is
///     free.
///
/// Obstacles and holes of the local map and the boundary of the geofence count like points of the
/// obstacle map. By default the robot drives by plan, with a goal (planner/goal_drive.hpp) and
/// without one (planner/roaming.hpp). Turn gets it out where no plan does. Brake has the last word
/// in all cases.
///
/// The robot gives way to people who walk: whatever was decided, it is stationary before they touch
/// it. While something else approaches it waits. The caller decides whether the inputs are fresh
/// enough (staleness.hpp); if not, it calls halt() instead of decide().
class Navigator {
 public:
  explicit Navigator(const NavigatorParams& params);

  // What Surroundings needs to know; documented there.
  void add_scan(const scan::Scan& scan, const geometry::SE2& T_odom_base,
                bool laser_is_held = false) {
    surroundings_.add_scan(scan, T_odom_base, laser_is_held);
  }
  void add_ranges(time::Timestamp stamp, const Proximity::Ranges& ranges_m,
                  const geometry::SE2& T_odom_base) {
    surroundings_.add_ranges(stamp, ranges_m, T_odom_base);
    leave_contact_.add_ranges(stamp, ranges_m);
  }

  /// The wheels rotate and the robot does not move: stops, and leaves what it touches.
  /// `T_odom_before`: when they did not slip yet.
  void leave_contact(time::Timestamp stamp, const geometry::SE2& T_odom_before,
                     const geometry::SE2& T_odom_base) {
    leave_contact_.begin(stamp, T_odom_before, T_odom_base, trail_);
  }
  /// Whether it still stops at a contact, so that the wheels may still slip.
  [[nodiscard]] bool is_stopping_at_contact() const { return leave_contact_.is_stopping(); }
  /// The frame map is another one from now on: forgets the contacts and the ground known in it.
  void forget_map();

  /// Decides what to do. `now.points_base`: those of the obstacle map; the local map's are added.
  [[nodiscard]] Decision decide(Situation now);

  /// GoalDrive::path_map(), for display; empty while the robot does not drive by plan.
  [[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> path_map(
      const geometry::SE2& T_map_base, const geometry::SE2& T_map_goal) const {
    return params_.planner.use ? goal_drive_.path_map(T_map_base, T_map_goal) : std::nullopt;
  }

  /// The people to whom it gives way, for display.
  [[nodiscard]] const PeopleTracker& people() const { return surroundings_.people(); }

  /// Has no scan if the robot does not drive by it.
  [[nodiscard]] const LocalMap& local_map() const { return surroundings_.local_map(); }

  /// Stops, and forgets what was seen: it may have changed when the robot drives again.
  [[nodiscard]] Decision halt(Reason reason);

  /// Stops in a gap in the scans that is shorter than a sweep; seen_directions.hpp says what is
  /// still known after it. If such gaps follow one another it does the same as halt().
  [[nodiscard]] Decision pause(Reason reason);

  /// Forgets everything, because the odom frame began anew.
  void reset();

 private:
  void record_drive(Situation& now);
  [[nodiscard]] std::optional<Decision> stop_at_contact(const Situation& now);
  void remember_contacts(const Situation& now);
  void watch_arrival(const Situation& now);
  void end_turn();
  [[nodiscard]] bool drives_by_plan(const Situation& now) const;
  void watch_first_look(const Situation& now);
  [[nodiscard]] Decision behave(const Situation& now);
  [[nodiscard]] std::optional<Decision> drive_ahead(const Situation& now);
  [[nodiscard]] Decision arrive(const Situation& now) const;
  [[nodiscard]] Decision brake(const Situation& now, Reason reason) const;
  [[nodiscard]] Decision slow_down(const Situation& now, Reason reason) const;
  [[nodiscard]] Decision with_free_distance(Decision decision, const Situation& now) const;
  [[nodiscard]] Decision wait(const Situation& now, Reason reason) const;
  [[nodiscard]] Decision turn(const Situation& now);
  [[nodiscard]] TurnInput turn_input(const Situation& now) const;
  [[nodiscard]] bool brake_lets_ahead(const Situation& now) const;
  [[nodiscard]] Side preferred_side(const Situation& now);
  [[nodiscard]] Decision back_up(const Situation& now);

  NavigatorParams params_;
  robot::Footprint body_;
  Surroundings surroundings_;
  Steering steering_;
  Brake brake_;
  Turn turn_;
  Trail trail_;
  BackUp back_up_;
  GoalDrive goal_drive_;
  Roaming roaming_;
  LeaveContact leave_contact_;
  std::vector<Contact> fresh_contacts_odom_;
  std::deque<Contact> contacts_map_;
  std::optional<Eigen::Vector2d> arrived_map_;  // the goal at which the robot is; empty: at none
  bool has_looked_ = false;                     ///< ahead, since the start
  std::optional<geometry::SE2> turn_ended_at_;  ///< T_odom_base
};

}  // namespace nodmap::navigator
