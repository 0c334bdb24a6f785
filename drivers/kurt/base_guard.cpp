// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/base_guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/robot/stopping.hpp"

namespace nodmap::kurt {
namespace {

// From the measurement to the wheels: one cycle of the sensors and one control period.
constexpr double kReactionS = 0.1;
// Vibration exceeds any tilt for a moment only.
constexpr time::Duration kTiltedFor = 500ms;
// Distance of the body's corners from the centre, by which they move when the robot rotates.
constexpr double kTurningRadiusM = 0.3;
// For this long what was seen slows the robot down, also when the sensor says nothing more.
constexpr time::Duration kSeenFor = 500ms;
constexpr double kUnlimitedMps = std::numeric_limits<double>::infinity();
// At slower commands a wheel may stand still although nothing blocks it.
constexpr double kSurelyTurningMps = 0.05;
// An encoder at rest may count one tick back and forth. A wheel has turned after more.
constexpr int kAtRestTicks = 1;

constexpr int kSonarNearest = 100;  // raw; a nearer obstacle gives a smaller value
// By which an obstacle approaches between two readings of the sonar, at 2 m/s.
constexpr double kApproachM = 0.15;

}  // namespace

const char* name_of(Alarm alarm) {
  switch (alarm) {
    case Alarm::kBumper:
      return "its bumper";
    case Alarm::kTilt:
      return "its tilt sensor";
    case Alarm::kStall:
      return "a stalled motor";
  }
  return "";
}

void BaseGuard::add(const RangeReadings& readings, time::SteadyTime now) {
  if (readings.sonar_raw) {
    add_sonar(*readings.sonar_raw, now);
  }
  for (const auto& [sensor, corner] :
       {std::pair(Infrared::kLeftFront, &left_corner_), {Infrared::kRightFront, &right_corner_}}) {
    if (const auto& raw = readings.infrared_raw[static_cast<std::size_t>(sensor)]) {
      const bool is_too_near_to_measure = infrared_range_m(*raw) == 0.0;
      *corner = is_too_near_to_measure ? std::optional(Seen{0.0, now}) : std::nullopt;
    }
  }
  if (const auto& raw = readings.infrared_raw[static_cast<std::size_t>(Infrared::kBack)]) {
    if (const auto range_m = infrared_range_m(*raw)) {
      behind_ = {*range_m, now};
    } else {
      behind_.reset();
    }
  }
}

void BaseGuard::add_sonar(int raw, time::SteadyTime now) {
  if (const auto range_m = sonar_range_m(raw)) {
    ahead_ = {*range_m, now};
  } else if (raw < kSonarNearest && ahead_ && ahead_->range_m < params_.near_m + kApproachM) {
    ahead_ = {0.0, now};  // the obstacle is now too near to be measured
  } else {
    ahead_.reset();
  }
}

void BaseGuard::add(const Tilt& tilt, time::SteadyTime now) {
  if (std::max(std::abs(tilt.roll_rad), std::abs(tilt.pitch_rad)) <= params_.max_tilt_rad) {
    tilted_since_.reset();
    is_tilted_ = false;
    return;
  }
  tilted_since_ = tilted_since_.value_or(now);
  if (now - *tilted_since_ >= kTiltedFor && !std::exchange(is_tilted_, true)) {
    alarm_ = Alarm::kTilt;
  }
}

void BaseGuard::add(const Bumpers& bumpers) {
  const bool is_touched = params_.use_bumper && bumpers.is_touched;
  if (!std::exchange(is_touched_, is_touched) && is_touched) {
    alarm_ = Alarm::kBumper;
  }
}

void BaseGuard::add(const EncoderTicks& ticks, const WheelSpeeds& commanded, time::SteadyTime now) {
  const time::Duration longest = std::max(left_stall_.add(ticks.left, commanded.left_mps, now),
                                          right_stall_.add(ticks.right, commanded.right_mps, now));
  if (longest >= time::from_seconds(params_.stall_s)) {
    alarm_ = Alarm::kStall;
  }
}

time::Duration BaseGuard::StallTimer::add(int ticks, double commanded_mps, time::SteadyTime now) {
  ticks_ += ticks;
  if (std::abs(commanded_mps) < kSurelyTurningMps) {
    since_.reset();
    ticks_ = 0;
    return {};
  }
  if (!since_ || std::abs(ticks_) > kAtRestTicks) {
    since_ = now;
    ticks_ = 0;
  }
  return now - *since_;
}

DriveCommand BaseGuard::limit(const DriveCommand& command, time::SteadyTime now) const {
  double safe_mps = params_.use_ranges ? safe_speed_mps(command, now) : kUnlimitedMps;
  double speed_mps = std::abs(command.forward_mps);
  if (lasting_alarm()) {
    safe_mps = std::min(safe_mps, params_.creep_mps);
    speed_mps = std::max(speed_mps, kTurningRadiusM * std::abs(command.yaw_rate_rad_s));
  }
  if (speed_mps <= safe_mps) {
    return command;
  }
  const double slower = safe_mps / speed_mps;
  return {slower * command.forward_mps, slower * command.yaw_rate_rad_s};
}

double BaseGuard::safe_speed_mps(const DriveCommand& command, time::SteadyTime now) const {
  if (command.forward_mps <= 0.0) {
    return safe_speed_mps(behind_, now);
  }
  return std::min({safe_speed_mps(ahead_, now), safe_speed_mps(left_corner_, now),
                   safe_speed_mps(right_corner_, now)});
}

double BaseGuard::safe_speed_mps(const std::optional<Seen>& seen, time::SteadyTime now) const {
  if (!seen || now - seen->at > kSeenFor) {
    return kUnlimitedMps;
  }
  const double distance_m = std::max(0.0, seen->range_m - params_.near_m);
  return std::max(params_.creep_mps,
                  robot::stoppable_speed(distance_m, kReactionS, deceleration_mps2_));
}

std::optional<Alarm> BaseGuard::take_alarm() {
  return std::exchange(alarm_, std::nullopt);
}

std::optional<Alarm> BaseGuard::lasting_alarm() const {
  if (is_touched_) {
    return Alarm::kBumper;
  }
  return is_tilted_ ? std::optional(Alarm::kTilt) : std::nullopt;
}

}  // namespace nodmap::kurt
