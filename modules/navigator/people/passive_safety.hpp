// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/robot/footprint.hpp"
#include "common/robot/robot_params.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/people/person.hpp"
#include "modules/navigator/twist.hpp"

namespace nodmap::navigator {

/// Passive motion safety (Bouraine, Fraichard and Salhi, Autonomous Robots 2012): the robot is
/// stationary before it and a person touch. It cannot keep a person from walking into it, but it
/// does not drive into anybody.
class PassiveSafety {
 public:
  explicit PassiveSafety(const NavigatorParams& params);

  /// Whether the robot is stationary before anybody touches it, if it keeps its motion for the
  /// reaction time and then brakes along its arc. People (in base) are discs with constant
  /// velocity; they grow with time by the error of the velocity, and out of sight by the distance
  /// walked.
  [[nodiscard]] bool is_safe(const Twist& twist, const People& people) const;

  /// The same with all of the brakes' force: whether it is not yet too late for an emergency stop.
  [[nodiscard]] bool can_stop(const Twist& twist, const People& people) const;

  /// Whether driving avoids a contact that stopping does not. Within two seconds somebody would
  /// touch the robot if it braked from its present motion, and nobody would if it changed to the
  /// commanded one. Velocities count without their error if even braking comes too late.
  [[nodiscard]] bool escapes(const Twist& present, const Twist& commanded,
                             const People& people) const;

  /// The greatest factor on the motion, from 0 to 1, with which it is safe.
  [[nodiscard]] double safe_factor(const Twist& twist, const People& people) const;

 private:
  [[nodiscard]] bool keeps_clear(Twist twist, const Twist& command, const People& people) const;
  [[nodiscard]] bool stops_in_time(const Twist& twist, double deceleration_mps2,
                                   const People& people) const;
  [[nodiscard]] bool stops_in_time(const Twist& twist, double deceleration_mps2,
                                   const Person& person) const;

  robot::Footprint body_;
  robot::Braking braking_;
  BaseParams base_params_;
  double reaction_s_;
  double margin_m_;
};

}  // namespace nodmap::navigator
