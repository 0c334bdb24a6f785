// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/contact/leave_contact.hpp"

#include <algorithm>
#include <cmath>

#include "common/robot/infrared.hpp"

namespace nodmap::navigator {
namespace {

// So far away the robot can turn on the spot.
constexpr double kLeaveM = 0.3;
// Slower wheels count as stationary: four steps of the base's speed command.
constexpr double kWheelsStandMps = 0.04;
// BASE_SENSORS comes every 50 ms.
constexpr time::Duration kFreshRanges = 200ms;
// The robot ends nearer than this to what is measured behind it: the error of a range finder, and
// what it moves between two readings and until it stops, 2 cm. Its corners come as near to things
// as they have passed them on the way.
constexpr double kBehindM = 0.08;
constexpr double kCornerM = 0.04;
// At 0.1 m/s it takes 3 s after the wheels have stopped. It does not wait for ever for somebody
// behind it; and whoever has halted it for longer may have moved it, or stand on the way back.
constexpr time::Duration kLongestLeaving = 10s;
// The base stops from any speed in less than half of it. Wheels that rotate for longer do so by
// themselves, as on a slope, or somebody pushes the robot.
constexpr time::Duration kLongestStopping = 5s;

}  // namespace

// The contact is a little beyond T_odom_before, on the same strip: what is free behind the one is
// free behind the other.
void LeaveContact::begin(time::Timestamp stamp, const geometry::SE2& T_odom_before,
                         const geometry::SE2& T_odom_base, const Trail& trail) {
  phase_ = Phase::kStopping;
  began_at_ = stamp;
  at_front_ = (T_odom_before.inverse() * T_odom_base).x >= 0.0;
  const auto path = trail.path_back(T_odom_before);
  curvature_ = path ? path->curvature : 0.0;
  distance_m_ = std::min(kLeaveM, trail.distance_backwards(T_odom_before, curvature_));
}

void LeaveContact::add_ranges(time::Timestamp stamp, const Proximity::Ranges& ranges_m) {
  ranges_m_ = ranges_m;
  ranges_at_ = stamp;
}

std::optional<Contact> LeaveContact::take_contact(const Situation& now) {
  const bool is_stationary = std::abs(now.forward_mps) <= kWheelsStandMps;
  if (phase_ != Phase::kStopping ||
      (!is_stationary && std::chrono::abs(now.stamp - began_at_) <= kLongestStopping)) {
    return std::nullopt;
  }
  phase_ = is_stationary && at_front_ ? Phase::kLeaving : Phase::kNone;
  T_odom_contact_ = now.T_odom_base;
  return Contact{now.T_odom_base, at_front_};
}

std::optional<Decision> LeaveContact::step(const Situation& now) {
  if (phase_ != Phase::kLeaving || has_left(now)) {
    phase_ = Phase::kNone;
    return std::nullopt;
  }
  return backing(speed_mps_, curvature_, Why::kLeavesContact);
}

bool LeaveContact::has_left(const Situation& now) const {
  return geometry::distance_m(T_odom_contact_, now.T_odom_base) >= distance_m_ ||
         std::chrono::abs(now.stamp - began_at_) > kLongestLeaving || is_blocked_behind(now.stamp);
}

// A range finder that has not answered, NaN, or a base without any says nothing.
bool LeaveContact::is_blocked_behind(time::Timestamp stamp) const {
  if (!ranges_at_ || std::chrono::abs(stamp - *ranges_at_) > kFreshRanges) {
    return false;
  }
  const auto range_m = [this](robot::Infrared sensor) {
    return ranges_m_[static_cast<std::size_t>(sensor)];
  };
  return range_m(robot::Infrared::kBack) < kBehindM ||
         range_m(robot::Infrared::kLeftBack) < kCornerM ||
         range_m(robot::Infrared::kRightBack) < kCornerM;
}

}  // namespace nodmap::navigator
