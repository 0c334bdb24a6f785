// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/people/proximity.hpp"
#include "modules/navigator/situation.hpp"
#include "modules/navigator/trail.hpp"

namespace nodmap::navigator {

/// Where the body touches something that no beam shows: base, and which side of the body.
struct Contact {
  geometry::SE2 T_base;  ///< in odom or in map
  bool at_front = true;
};

/// What the robot does when its wheels slip against something: it stops, and if it has driven
/// forwards into it, it then backs up by 0.3 m the way it came.
///
/// Until the wheels are stationary, odometry counts a motion that is none. Only then does the
/// contact have a place in odom, and what has had one before must be begun anew.
///
/// Why it may back up although the laser does not look there and no map is left: it drives back on
/// the arc on which it came, no farther than its body stays on the strip that it drove a moment ago
/// (Trail), so slowly that the corners count as stationary, and no nearer to what the range finders
/// measure behind it than they err. Brake still gives way to people.
class LeaveContact {
 public:
  explicit LeaveContact(const NavigatorParams& params) : speed_mps_(params.back_up.speed_mps) {}

  /// The wheels slip. `T_odom_before`: when they did not yet; `trail`: of that time, too.
  void begin(time::Timestamp stamp, const geometry::SE2& T_odom_before,
             const geometry::SE2& T_odom_base, const Trail& trail);

  void add_ranges(time::Timestamp stamp, const Proximity::Ranges& ranges_m);

  /// Whether the wheels may still slip.
  [[nodiscard]] bool is_stopping() const { return phase_ == Phase::kStopping; }
  [[nodiscard]] bool is_active() const { return phase_ != Phase::kNone; }

  /// While stopping: the contact in odom, once the wheels are stationary. If they do not come to
  /// rest for 5 s, it is where the robot is then, and the robot does not back up.
  [[nodiscard]] std::optional<Contact> take_contact(const Situation& now);

  /// After that: the next motion. Ends, and returns nothing, once the robot has left.
  [[nodiscard]] std::optional<Decision> step(const Situation& now);

 private:
  enum class Phase : std::uint8_t { kNone, kStopping, kLeaving };

  [[nodiscard]] bool has_left(const Situation& now) const;
  [[nodiscard]] bool is_blocked_behind(time::Timestamp stamp) const;

  double speed_mps_;
  Phase phase_ = Phase::kNone;
  bool at_front_ = true;
  // Of the way back: 1/m, positive left when driven forwards; and how far it is known to be free.
  double curvature_ = 0.0;
  double distance_m_ = 0.0;
  geometry::SE2 T_odom_contact_;
  time::Timestamp began_at_{};
  Proximity::Ranges ranges_m_{};
  std::optional<time::Timestamp> ranges_at_;
};

}  // namespace nodmap::navigator
