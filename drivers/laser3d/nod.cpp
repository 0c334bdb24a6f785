// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/nod.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/angle.hpp"

namespace nodmap::laser3d {
namespace {

// The head reverses this near to an end: half of the scanner's step of 0.25 degrees (paper, II).
constexpr double kArrivedRad = geometry::deg_to_rad(0.125);
// A servo under load stops short of its goal, so a head at rest this near to the end has arrived.
constexpr double kNearRad = geometry::deg_to_rad(2.0);
constexpr double kAtRestRatio = 0.1;  // of the commanded speed

constexpr double kLongestSweepS = 3600.0;

constexpr time::Duration kStarting = 100ms;
// A change of pitch by this much is movement: three steps of the servo's encoder, more than its
// jitter.
constexpr double kMovedRad = geometry::deg_to_rad(0.25);
// Eight readings at 200 per second. Short, because until a stall is detected the robot drives
// towards what the laser does not see.
constexpr time::Duration kMovePatience = 40ms;
constexpr time::Duration kSilence = 300ms;
constexpr double kSlowestRadS = 0.05;
constexpr double kReversalDelayS = 0.020;  // until the servo has received the command to reverse

}  // namespace

bool Nod::command(const AreaOfInterest& area, time::SteadyTime decided) {
  const bool valid = std::isfinite(area.min_rad) && std::isfinite(area.max_rad) &&
                     area.min_rad <= area.max_rad && area.sweep_s > 0.0 &&
                     area.sweep_s <= kLongestSweepS;
  if (valid) {
    commanded_ = area;
    decided_ = decided;
  }
  return valid;
}

time::Duration Nod::nod_period(time::SteadyTime now) const {
  const AreaOfInterest current = area(now);
  const double range_rad = current.max_rad - current.min_rad;
  if (range_rad < robot::kHeldRad) {
    return {};
  }
  const double sweep_s = head_.sweep_s(range_rad, head_.rate_rad_s(range_rad, current.sweep_s));
  return time::from_seconds(2.0 * std::min(sweep_s, kLongestSweepS));
}

Nod::Aim Nod::step(const PitchSample& where, time::SteadyTime now) {
  const AreaOfInterest current = area(now);
  watch_for_stall(where);
  const double range_rad = current.max_rad - current.min_rad;
  nods_ = range_rad >= robot::kHeldRad;
  if (!nods_) {
    aim_ = {0.5 * (current.min_rad + current.max_rad), 0.5 * head_.pitch_rate_rad_s};
    return aim_;
  }
  if (has_arrived(where, current)) {
    reverse(where.stamp);
    ++sweep_;
  }
  aim_ = {is_upwards_ ? current.max_rad : current.min_rad,
          head_.rate_rad_s(range_rad, current.sweep_s)};
  return aim_;
}

AreaOfInterest Nod::area(time::SteadyTime now) const {
  const bool fresh = commanded_ && now - decided_ <= time::from_seconds(params_.command_timeout_s);
  return within_limits(fresh ? *commanded_ : params_.fallback);
}

AreaOfInterest Nod::within_limits(AreaOfInterest area) const {
  area.min_rad = std::clamp(area.min_rad, head_.pitch_min_rad, head_.pitch_max_rad);
  area.max_rad = std::clamp(area.max_rad, head_.pitch_min_rad, head_.pitch_max_rad);
  return area;
}

bool Nod::has_arrived(const PitchSample& where, const AreaOfInterest& area) const {
  const double left = is_upwards_ ? area.max_rad - where.pitch_rad : where.pitch_rad - area.min_rad;
  const double rate = is_upwards_ ? where.rate_rad_s : -where.rate_rad_s;
  // Just after a reversal the head is also at rest, so the rate is ignored until it has had time to
  // move.
  const bool at_rest =
      where.stamp - reversed_ > kStarting && rate < kAtRestRatio * aim_.speed_rad_s;
  return left <= kArrivedRad || (left <= kNearRad && at_rest);
}

void Nod::watch_for_stall(const PitchSample& where) {
  const bool holds = !nods_ && std::abs(aim_.goal_rad - where.pitch_rad) <= kNearRad;
  const bool moves = moved_ && std::abs(where.pitch_rad - moved_->pitch_rad) >= kMovedRad;
  if (holds || moves) {
    is_stalled_ = false;
  }
  // After a silence it is unknown whether the head has moved meanwhile.
  if (!moved_ || holds || moves || where.stamp - last_stamp_ > kSilence) {
    moved_ = where;
  }
  last_stamp_ = where.stamp;
  if (where.stamp - moved_->stamp > patience(where)) {
    is_stalled_ = true;
    moved_ = where;
    reverse(where.stamp);  // in the other direction it may be free
  }
}

time::Duration Nod::patience(const PitchSample& where) const {
  const double speed = std::max(aim_.speed_rad_s, kSlowestRadS);
  const double moving_s = 2.0 * kMovedRad / speed;
  const double braking_rad = speed * speed / (2.0 * head_.pitch_acceleration_rad_s2);
  // After it was commanded to reverse, the head still moves on until it has braked.
  const time::Duration braking = time::from_seconds(speed / head_.pitch_acceleration_rad_s2);
  const bool reverses = moved_->stamp <= reversed_ + braking ||
                        std::abs(aim_.goal_rad - where.pitch_rad) <= braking_rad + kMovedRad;
  return kMovePatience + time::from_seconds(moving_s + (reverses ? reversal_s(speed) : 0.0));
}

// How much longer a reversal takes. If the head was last seen moving kMovedRad before the end, it
// comes to rest over that angle and moves away over twice that angle, with constant acceleration.
double Nod::reversal_s(double speed_rad_s) const {
  const double a = head_.pitch_acceleration_rad_s2;
  const double to_rest_s = std::sqrt(2.0 * kMovedRad / a);
  return std::min(2.0 * speed_rad_s / a, (1.0 + std::sqrt(2.0)) * to_rest_s) + kReversalDelayS;
}

void Nod::reverse(time::SteadyTime stamp) {
  is_upwards_ = !is_upwards_;
  reversed_ = stamp;
}

}  // namespace nodmap::laser3d
