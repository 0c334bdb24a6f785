// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/passive_safety.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/geometry/se2.hpp"
#include "modules/navigator/people/foresight.hpp"

namespace nodmap::navigator {
namespace {

constexpr double kStepS = 0.05;
constexpr double kForeseenS = 2.0;
// A motion that takes longer to stop than this is not one of a robot's, and not safe.
constexpr double kLongestStopS = 60.0;
// Slower counts as stationary. The limit for a contact that the robot causes is 0.05 m/s, and the
// base follows a command to within 0.02 m/s.
constexpr double kStationaryMps = 0.03;
// Factors on the speed that are tried; below the last the robot stops.
constexpr std::array kFactors{1.0, 0.85, 0.7, 0.55, 0.4, 0.27, 0.15};

}  // namespace

PassiveSafety::PassiveSafety(const NavigatorParams& params)
    : body_(params.robot.body.footprint()),
      braking_(params.robot.braking),
      base_params_(params.base),
      reaction_s_(params.drive.reaction_s),
      margin_m_(params.people.margin_m) {}

bool PassiveSafety::stops_in_time(const Twist& twist, double deceleration_mps2,
                                  const Person& person) const {
  const double corner_m = body_.turning_radius_m();
  const double speed_mps = std::abs(twist.forward_mps) + corner_m * std::abs(twist.yaw_rate_rad_s);
  // Linear and angular speed decrease together; the faster of the wheels takes the longest.
  const double braking_s = speed_mps / deceleration_mps2;
  geometry::SE2 pose;
  for (double t = 0.0; t < kLongestStopS; t += kStepS) {
    const double factor =
        t <= reaction_s_ ? 1.0 : 1.0 - (t - reaction_s_) / std::max(braking_s, 1e-6);
    if (factor * speed_mps < kStationaryMps) {
      return true;
    }
    const Eigen::Vector2d p =
        pose.inverse() * (person.is_in_sight ? person.position_after(t) : person.position);
    // Out of sight, a person may turn: the prediction grows by the whole distance walked.
    const double error_m = person.is_in_sight
                               ? std::hypot(person.position_sigma_m, person.velocity_sigma_mps * t)
                               : person.position_sigma_m + person.velocity.norm() * t;
    if (distance_to_body(p, body_) < person.radius_m + margin_m_ + error_m) {
      return false;
    }
    const double yaw_rad = kStepS * factor * twist.yaw_rate_rad_s;
    pose = pose * geometry::SE2{kStepS * factor * twist.forward_mps, 0.0, yaw_rad};
  }
  return false;
}

// Whether nobody touches a robot that changes to the commanded motion and keeps it.
bool PassiveSafety::keeps_clear(Twist twist, const Twist& command, const People& people) const {
  geometry::SE2 pose;
  for (double t = 0.0; t <= kForeseenS; t += kStepS) {
    if (std::ranges::any_of(people, [&](const Person& person) {
          return is_touched(body_, pose, person, t, margin_m_);
        })) {
      return false;
    }
    twist = after(twist, command, kStepS, base_params_);
    pose = pose * geometry::SE2{kStepS * twist.forward_mps, 0.0, kStepS * twist.yaw_rate_rad_s};
  }
  return true;
}

bool PassiveSafety::escapes(const Twist& present, const Twist& commanded,
                            const People& people) const {
  if (keeps_clear(present, {}, people)) {
    return false;
  }
  if (can_stop(present, people)) {
    return keeps_clear(present, commanded, people);
  }
  // Braking leads to a contact as well, so the likely motion counts instead of the worst one.
  People likely = people;
  for (Person& person : likely) {
    person.velocity_sigma_mps = 0.0;
  }
  return keeps_clear(present, commanded, likely);
}

bool PassiveSafety::is_safe(const Twist& twist, const People& people) const {
  return stops_in_time(twist, braking_.deceleration_mps2, people);
}

bool PassiveSafety::can_stop(const Twist& twist, const People& people) const {
  return stops_in_time(twist, braking_.emergency_deceleration_mps2, people);
}

bool PassiveSafety::stops_in_time(const Twist& twist, double deceleration_mps2,
                                  const People& people) const {
  return std::ranges::all_of(people, [&](const Person& person) {
    return stops_in_time(twist, deceleration_mps2, person);
  });
}

double PassiveSafety::safe_factor(const Twist& twist, const People& people) const {
  if (people.empty()) {
    return 1.0;
  }
  if (twist.forward_mps < 0.0) {
    // The laser does not look backwards, and where one person walks there may be others.
    return 0.0;
  }
  for (const double factor : kFactors) {
    if (is_safe(twist.scaled(factor), people)) {
      return factor;
    }
  }
  return 0.0;
}

}  // namespace nodmap::navigator
