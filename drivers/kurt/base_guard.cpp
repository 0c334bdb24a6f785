// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/base_guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/robot/stopping.hpp"

namespace nodmap::kurt {
namespace {

/// Older readings are ignored. The base sends each sensor 15 times a second.
constexpr time::Duration kReadingLife = 500ms;
/// From the measurement to the wheels: one cycle of the sensors and one control period.
constexpr double kReactionS = 0.1;
/// Vibration exceeds any tilt for a moment only.
constexpr time::Duration kTiltedFor = 500ms;
/// At slower commands a wheel may stand still although nothing blocks it.
constexpr double kSurelyTurningMps = 0.05;

constexpr int kSonarNearest = 100;     // raw; a nearer obstacle gives a smaller value
constexpr int kInfraredNearest = 800;  // raw; a nearer obstacle gives a larger value

}  // namespace

const char* name_of(Alarm alarm) {
  switch (alarm) {
    case Alarm::kBumper:
      return "its bumper";
    case Alarm::kTilt:
      return "its tilt sensor";
    case Alarm::kStall:
      return "its motors, which were stalled";
  }
  return "";
}

void BaseGuard::add(const RangeReadings& readings, time::SteadyTime now) {
  if (readings.sonar_raw) {
    if (const auto range_m = sonar_range_m(*readings.sonar_raw)) {
      ahead_ = {*range_m, now};
    } else if (*readings.sonar_raw < kSonarNearest && ahead_ && ahead_->range_m < params_.near_m) {
      ahead_->at = now;  // the obstacle is now too near to be measured
    } else {
      ahead_.reset();
    }
  }
  if (const auto& raw = readings.infrared_raw[static_cast<std::size_t>(Infrared::kBack)]) {
    if (const auto range_m = infrared_range_m(*raw)) {
      behind_ = {*range_m, now};
    } else if (*raw > kInfraredNearest) {
      behind_ = {0.0, now};
    } else {
      behind_.reset();
    }
  }
}

void BaseGuard::add(const Tilt& tilt, time::SteadyTime now) {
  if (std::max(std::abs(tilt.roll_rad), std::abs(tilt.pitch_rad)) <= params_.max_tilt_rad) {
    tilted_since_.reset();
    return;
  }
  tilted_since_ = tilted_since_.value_or(now);
  if (now - *tilted_since_ >= kTiltedFor) {
    alarm_ = Alarm::kTilt;
  }
}

void BaseGuard::add(const Bumpers& bumpers) {
  if (params_.use_bumper && bumpers.is_touched) {
    alarm_ = Alarm::kBumper;
  }
}

void BaseGuard::add(const EncoderTicks& ticks, const WheelSpeeds& commanded, time::SteadyTime now) {
  const bool should_turn =
      std::min(std::abs(commanded.left_mps), std::abs(commanded.right_mps)) >= kSurelyTurningMps;
  if (!should_turn || ticks.left != 0 || ticks.right != 0) {
    stalled_since_.reset();
    return;
  }
  stalled_since_ = stalled_since_.value_or(now);
  if (now - *stalled_since_ >= time::from_seconds(params_.stall_s)) {
    alarm_ = Alarm::kStall;
  }
}

DriveCommand BaseGuard::limit(const DriveCommand& command, time::SteadyTime now) const {
  const double safe_mps = safe_speed_mps(command.forward_mps > 0.0 ? ahead_ : behind_, now);
  const double speed_mps = std::abs(command.forward_mps);
  if (!params_.use_ranges || speed_mps <= safe_mps) {
    return command;
  }
  const double slower = safe_mps / speed_mps;
  return {slower * command.forward_mps, slower * command.yaw_rate_rad_s};
}

double BaseGuard::safe_speed_mps(const std::optional<Seen>& seen, time::SteadyTime now) const {
  if (!seen || now - seen->at > kReadingLife) {
    return std::numeric_limits<double>::infinity();
  }
  const double distance_m = std::max(0.0, seen->range_m - params_.near_m);
  return std::max(params_.creep_mps,
                  robot::stoppable_speed(distance_m, kReactionS, deceleration_mps2_));
}

std::optional<Alarm> BaseGuard::take_alarm() {
  return std::exchange(alarm_, std::nullopt);
}

}  // namespace nodmap::kurt
