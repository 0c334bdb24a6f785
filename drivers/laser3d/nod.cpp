// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/nod.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/angle.hpp"

namespace nodmap::laser3d {
namespace {

// Near enough to an end to turn there (R3: what a servo keeps when standing).
constexpr double kArrivedRad = geometry::deg_to_rad(0.125);
// A servo under load stops short of its goal: this near, standing still is arriving.
constexpr double kNearRad = geometry::deg_to_rad(2.0);
constexpr double kStandingShare = 0.1;  // of the speed asked for

// An area of interest narrower than this is a fixed pitch.
constexpr double kFixedRad = geometry::deg_to_rad(0.5);

constexpr double kLongestSweepS = 3600.0;

constexpr std::int64_t kStartingUs = 100'000;
// So much is movement: six steps of the servo's encoder, more than it trembles by.
constexpr double kMovedRad = geometry::deg_to_rad(0.5);
// Eight readings on a line with 200 of them a second. The robot drives blind meanwhile.
constexpr std::int64_t kPatienceUs = 40'000;
constexpr std::int64_t kSilenceUs = 300'000;
constexpr double kSlowestRadS = 0.05;
constexpr double kTurnedS = 0.020;  // until the command to turn has reached the servo

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
  const double sweep_s = range_rad / speed_rad_s + speed_rad_s / settings_.acceleration_rad_s2;
  return std::llround(2e6 * std::min(sweep_s, kLongestSweepS));
}

Nod::Aim Nod::step(const PitchSample& where, std::int64_t now_us) {
  const AreaOfInterest now = area(now_us);
  watch_for_stall(where);
  nods_ = now.max_rad - now.min_rad >= kFixedRad;
  if (!nods_) {
    aim_ = {0.5 * (now.min_rad + now.max_rad), 0.5 * settings_.max_speed_rad_s};
    return aim_;
  }
  if (has_arrived(where, now)) {
    turn(where.time_us);
    ++sweep_;
  }
  aim_ = {upwards_ ? now.max_rad : now.min_rad, speed_for(now)};
  return aim_;
}

AreaOfInterest Nod::area(std::int64_t now_us) const {
  const bool fresh = commanded_ && now_us - commanded_us_ <= settings_.command_timeout_us;
  return within_limits(fresh ? *commanded_ : settings_.fallback);
}

AreaOfInterest Nod::within_limits(AreaOfInterest area) const {
  area.min_rad = std::clamp(area.min_rad, settings_.min_rad, settings_.max_rad);
  area.max_rad = std::clamp(area.max_rad, settings_.min_rad, settings_.max_rad);
  return area;
}

double Nod::speed_for(const AreaOfInterest& area) const {
  // A sweep takes range / v, and v / a for the turn: solved for v.
  const double range = area.max_rad - area.min_rad;
  const double a = settings_.acceleration_rad_s2;
  const double root = area.sweep_s * area.sweep_s - 4.0 * range / a;
  const double speed =
      root < 0.0 ? settings_.max_speed_rad_s : 0.5 * a * (area.sweep_s - std::sqrt(root));
  return std::min(speed, settings_.max_speed_rad_s);
}

bool Nod::has_arrived(const PitchSample& where, const AreaOfInterest& area) const {
  const double left = upwards_ ? area.max_rad - where.pitch_rad : where.pitch_rad - area.min_rad;
  const double rate = upwards_ ? where.rate_rad_s : -where.rate_rad_s;
  // Just turned it stands, too: the rate says nothing before it has had time to move.
  const bool stands =
      where.time_us - turned_us_ > kStartingUs && rate < kStandingShare * aim_.speed_rad_s;
  return left <= kArrivedRad || (left <= kNearRad && stands);
}

void Nod::watch_for_stall(const PitchSample& where) {
  const bool holds = !nods_ && std::abs(aim_.goal_rad - where.pitch_rad) <= kNearRad;
  const bool moves = moved_ && std::abs(where.pitch_rad - moved_->pitch_rad) >= kMovedRad;
  if (holds || moves) {
    stalled_ = false;
  }
  // After a silence nobody has seen what it did meanwhile.
  if (!moved_ || holds || moves || where.time_us - last_us_ > kSilenceUs) {
    moved_ = where;
  }
  last_us_ = where.time_us;
  if (where.time_us - moved_->time_us > patience_us(where)) {
    stalled_ = true;
    moved_ = where;
    turn(where.time_us);  // the way back may be free
  }
}

std::int64_t Nod::patience_us(const PitchSample& where) const {
  const double speed = std::max(aim_.speed_rad_s, kSlowestRadS);
  const double moving_s = 2.0 * kMovedRad / speed;
  const double braking_rad = speed * speed / (2.0 * settings_.acceleration_rad_s2);
  const bool turns = moved_->time_us <= turned_us_ ||
                     std::abs(aim_.goal_rad - where.pitch_rad) <= braking_rad + kMovedRad;
  const double turning_s = turns ? 2.0 * speed / settings_.acceleration_rad_s2 + kTurnedS : 0.0;
  return kPatienceUs + static_cast<std::int64_t>(1e6 * (moving_s + turning_s));
}

void Nod::turn(std::int64_t time_us) {
  upwards_ = !upwards_;
  turned_us_ = time_us;
}

}  // namespace nodmap::laser3d
