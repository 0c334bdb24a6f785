// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/nod.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/angle.hpp"

namespace nodmap::laser3d {
namespace {

// Near enough to an end to reverse there: half of the scanner's step of 0.25 degrees (paper, II).
constexpr double kArrivedRad = geometry::deg_to_rad(0.125);
// A servo under load stops short of its goal: a head at rest that is so near has arrived.
constexpr double kNearRad = geometry::deg_to_rad(2.0);
constexpr double kAtRestRatio = 0.1;  // of the speed asked for

// An area of interest narrower than this is a fixed pitch.
constexpr double kFixedRad = geometry::deg_to_rad(0.5);

constexpr double kLongestSweepS = 3600.0;

constexpr std::int64_t kStartingUs = 100'000;
// A change of pitch by this much is movement: six steps of the servo's encoder, more than it
// trembles by.
constexpr double kMovedRad = geometry::deg_to_rad(0.5);
// Eight readings at 200 a second. Kept short, because until the stall is known the robot drives
// towards what the laser does not see.
constexpr std::int64_t kPatienceUs = 40'000;
constexpr std::int64_t kSilenceUs = 300'000;
constexpr double kSlowestRadS = 0.05;
constexpr double kReversalDelayS = 0.020;  // until the command to reverse has reached the servo

}  // namespace

bool Nod::command(const AreaOfInterest& area, std::int64_t now_us) {
  const bool valid = std::isfinite(area.min_rad) && std::isfinite(area.max_rad) &&
                     area.min_rad <= area.max_rad && std::isfinite(area.sweep_s) &&
                     area.sweep_s > 0.0;
  if (valid) {
    commanded_ = area;
    commanded_us_ = now_us;
  }
  return valid;
}

std::int64_t Nod::nod_us(std::int64_t now_us) const {
  const AreaOfInterest now = area(now_us);
  const double range_rad = now.max_rad - now.min_rad;
  if (range_rad < kFixedRad) {
    return 0;
  }
  const double speed_rad_s = speed_for(now);
  const double sweep_s =
      range_rad / speed_rad_s + speed_rad_s / robot_.head.pitch_acceleration_rad_s2;
  return std::llround(2e6 * std::min(sweep_s, kLongestSweepS));
}

Nod::Aim Nod::step(const PitchSample& where, std::int64_t now_us) {
  const AreaOfInterest now = area(now_us);
  watch_for_stall(where);
  nods_ = now.max_rad - now.min_rad >= kFixedRad;
  if (!nods_) {
    aim_ = {0.5 * (now.min_rad + now.max_rad), 0.5 * robot_.head.pitch_rate_rad_s};
    return aim_;
  }
  if (has_arrived(where, now)) {
    reverse(where.time_us);
    ++sweep_;
  }
  aim_ = {upwards_ ? now.max_rad : now.min_rad, speed_for(now)};
  return aim_;
}

AreaOfInterest Nod::area(std::int64_t now_us) const {
  const bool fresh =
      commanded_ && now_us - commanded_us_ <= std::llround(1e6 * params_.command_timeout_s);
  return within_limits(fresh ? *commanded_ : params_.fallback);
}

AreaOfInterest Nod::within_limits(AreaOfInterest area) const {
  area.min_rad = std::clamp(area.min_rad, robot_.head.pitch_min_rad, robot_.head.pitch_max_rad);
  area.max_rad = std::clamp(area.max_rad, robot_.head.pitch_min_rad, robot_.head.pitch_max_rad);
  return area;
}

double Nod::speed_for(const AreaOfInterest& area) const {
  // A sweep takes range / v, and v / a for the reversal: solved for v.
  const double range = area.max_rad - area.min_rad;
  const double a = robot_.head.pitch_acceleration_rad_s2;
  const double root = area.sweep_s * area.sweep_s - 4.0 * range / a;
  const double speed =
      root < 0.0 ? robot_.head.pitch_rate_rad_s : 0.5 * a * (area.sweep_s - std::sqrt(root));
  return std::min(speed, robot_.head.pitch_rate_rad_s);
}

bool Nod::has_arrived(const PitchSample& where, const AreaOfInterest& area) const {
  const double left = upwards_ ? area.max_rad - where.pitch_rad : where.pitch_rad - area.min_rad;
  const double rate = upwards_ ? where.rate_rad_s : -where.rate_rad_s;
  // Just reversed it is at rest, too: the rate says nothing before it has had time to move.
  const bool at_rest =
      where.time_us - reversed_us_ > kStartingUs && rate < kAtRestRatio * aim_.speed_rad_s;
  return left <= kArrivedRad || (left <= kNearRad && at_rest);
}

void Nod::watch_for_stall(const PitchSample& where) {
  const bool holds = !nods_ && std::abs(aim_.goal_rad - where.pitch_rad) <= kNearRad;
  const bool moves = moved_ && std::abs(where.pitch_rad - moved_->pitch_rad) >= kMovedRad;
  if (holds || moves) {
    stalled_ = false;
  }
  // After a silence nobody knows what the head did meanwhile.
  if (!moved_ || holds || moves || where.time_us - last_us_ > kSilenceUs) {
    moved_ = where;
  }
  last_us_ = where.time_us;
  if (where.time_us - moved_->time_us > patience_us(where)) {
    stalled_ = true;
    moved_ = where;
    reverse(where.time_us);  // in the other direction it may be free
  }
}

std::int64_t Nod::patience_us(const PitchSample& where) const {
  const double speed = std::max(aim_.speed_rad_s, kSlowestRadS);
  const double moving_s = 2.0 * kMovedRad / speed;
  const double braking_rad = speed * speed / (2.0 * robot_.head.pitch_acceleration_rad_s2);
  const bool reverses = moved_->time_us <= reversed_us_ ||
                        std::abs(aim_.goal_rad - where.pitch_rad) <= braking_rad + kMovedRad;
  const double reversal_s =
      reverses ? 2.0 * speed / robot_.head.pitch_acceleration_rad_s2 + kReversalDelayS : 0.0;
  return kPatienceUs + static_cast<std::int64_t>(1e6 * (moving_s + reversal_s));
}

void Nod::reverse(std::int64_t time_us) {
  upwards_ = !upwards_;
  reversed_us_ = time_us;
}

}  // namespace nodmap::laser3d
