// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/robot/footprint.hpp"
#include "common/robot/robot_params.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/people/person.hpp"

namespace nodmap::navigator {

/// A motion of base: forward speed and yaw rate.
struct Twist {
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;

  [[nodiscard]] Twist scaled(double factor) const {
    return {factor * forward_mps, factor * yaw_rate_rad_s};
  }
};

/// Passive motion safety (Bouraine, Fraichard and Salhi, Autonomous Robots 2012): should anybody
/// touch the robot, it is stationary by then. The robot cannot keep a person from walking into it,
/// but it does not drive into one.
class PassiveSafety {
 public:
  PassiveSafety(const robot::RobotParams& robot, const DriveParams& drive,
                const PeopleParams& params);

  /// Whether a robot that moves like this for the reaction time and then brakes along its arc is
  /// stationary before anyone touches it. People are discs that go on at their velocity; with
  /// time they grow by the error of it, and those who are out of sight by what they walk. In base.
  [[nodiscard]] bool is_safe(const Twist& twist, const People& people) const;

  /// The greatest factor from 0 to 1 with which the motion is safe.
  [[nodiscard]] double safe_factor(const Twist& twist, const People& people) const;

 private:
  [[nodiscard]] bool is_safe(const Twist& twist, const Person& person) const;

  robot::Footprint body_;
  double deceleration_mps2_;
  double reaction_s_;
  double margin_m_;
};

/// From a rectangle at a pose to a point, metres; 0 inside.
[[nodiscard]] double distance_to_body(const Eigen::Vector2d& p_base, const robot::Footprint& body);

}  // namespace nodmap::navigator
