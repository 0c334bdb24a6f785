// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/robot/footprint.hpp"
#include "common/robot/robot_params.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/people/foresight.hpp"
#include "modules/navigator/people/person.hpp"

namespace nodmap::navigator {

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

  /// Whether standing does not help, but a motion does: within two seconds somebody would touch the
  /// robot that brakes from its present motion, and nobody one that goes over to the commanded one.
  /// If he would touch it before it is stationary his velocity counts without its error.
  [[nodiscard]] bool escapes(const Twist& present, const Twist& commanded,
                             const People& people) const;

  /// The greatest factor from 0 to 1 with which the motion is safe.
  [[nodiscard]] double safe_factor(const Twist& twist, const People& people) const;

 private:
  [[nodiscard]] bool keeps_clear(Twist twist, const Twist& command, const People& people) const;
  [[nodiscard]] bool is_safe(const Twist& twist, const Person& person) const;

  robot::Footprint body_;
  double deceleration_mps2_;
  double reaction_s_;
  double margin_m_;
};

}  // namespace nodmap::navigator
