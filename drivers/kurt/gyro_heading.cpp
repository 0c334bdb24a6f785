// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/gyro_heading.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/geometry/angle.hpp"
#include "drivers/kurt/encoder_clock.hpp"

namespace nodmap::kurt {
namespace {

using geometry::deg_to_rad;

// The gyro sends an angle every 7 periods; over as many its correction is spread.
constexpr int kReleasePeriods = 7;
// Half a second: seven angles in a row are not lost by accident. Until then, and from then on, the
// rotation is that of the wheels, so the limit only decides when this is said.
constexpr int kSilentPeriods = 50;
// In a period. More than one tick of an encoder that rests on an edge (17 um, of kurt_fast 74, and
// half as much in the mean of both sides), less than one side at the slowest commanded speed, 1
// cm/s.
constexpr double kStillM = 0.04e-3;
// The body rocks on its tyres for a while after the wheels have stopped.
constexpr int kSettlePeriods = 30;
// Shorter paths say nothing about slip.
constexpr double kMinPathM = 0.002;
// An angle that is exactly the last one is that of a dead gyro if the wheels rotate by this much.
constexpr double kRotatesRad = deg_to_rad(0.1);

double variance_of(double sigma) {
  return sigma * sigma;
}

// The rotation between two angles, which wrap at 180 degrees or where their 32 bits end: the base's
// manual does not say which.
double rotation_between(double before_rad, double after_rad) {
  const double difference_rad = after_rad - before_rad;
  const auto is_smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
  return std::min({geometry::normalize_angle(difference_rad), difference_rad - kGyroRangeRad,
                   difference_rad + kGyroRangeRad},
                  is_smaller);
}

}  // namespace

std::string_view fault_of(GyroUse use) {
  switch (use) {
    case GyroUse::kSilent:
      return "the gyro is silent";
    case GyroUse::kFrozen:
      return "the gyro repeats one angle";
    case GyroUse::kDisagrees:
      return "the gyro disagrees with the wheels";
    case GyroUse::kRunsOff:
      return "the gyro runs off while the robot is stationary";
    case GyroUse::kOff:
    case GyroUse::kAbsent:
    case GyroUse::kUnsettled:
    case GyroUse::kUsed:
      break;
  }
  return "";
}

std::optional<double> GyroHeading::bias_rad_s() const {
  return bias_.rate_rad_s();
}

GyroHeading::Rotation GyroHeading::rotate(const WheelStep& wheels) {
  const double dt_s = kEncoderPeriodS * wheels.periods;
  const double predicted_rad = wheels.rotation_rad + slip_rad_per_m_ * wheels.path_m;
  last_step_ = {wheels.rotation_rad, predicted_rad, wheels.path_m, wheels.periods};
  since_.wheels_rad += wheels.rotation_rad;
  since_.predicted_rad += predicted_rad;
  since_.path_m += wheels.path_m;
  since_.periods += wheels.periods;
  still_periods_ = wheels.path_m <= kStillM * wheels.periods ? still_periods_ + wheels.periods : 0;
  bias_.age(dt_s);
  if (last_angle_rad_ && since_.periods > kSilentPeriods) {
    ++counts_.silences;
    use_ = GyroUse::kSilent;
    forget_angle();
  }
  double rotation_rad = predicted_rad;
  if (release_periods_ > 0) {
    const int periods = std::min(wheels.periods, release_periods_);
    const double released_rad = to_release_rad_ * periods / release_periods_;
    to_release_rad_ -= released_rad;
    release_periods_ -= periods;
    rotation_rad += released_rad;
  }
  return {rotation_rad,
          use_ == GyroUse::kUsed ? gyro_variance_rad2(rotation_rad, dt_s) : wheels.variance_rad2};
}

// Rotations to the left and to the right cancel each other's error of scale; each radian is taken
// to have one of its own.
double GyroHeading::gyro_variance_rad2(double rotation_rad, double dt_s) const {
  if (still_periods_ >= kSettlePeriods) {
    return 0.0;
  }
  return (variance_of(params_.noise_rad) + bias_.variance_rad2_per_s()) * dt_s +
         variance_of(params_.scale_sigma) * std::abs(rotation_rad);
}

void GyroHeading::add(const Gyro& gyro) {
  if (!params_.use_gyro) {
    return;
  }
  if (last_angle_rad_ && since_.periods == 0) {
    return;  // encoder frames were lost; the next angle will contain this one's rotation
  }
  const std::optional<double> before = std::exchange(last_angle_rad_, gyro.yaw_rad);
  const Interval interval = end_interval();
  if (!before) {
    if (use_ == GyroUse::kAbsent || use_ == GyroUse::kSilent) {
      resume();
    }
    return;
  }
  const double dt_s = kEncoderPeriodS * interval.periods;
  const double gyro_rad = params_.scale * rotation_between(*before, gyro.yaw_rad);
  if (still_periods_ >= kSettlePeriods) {
    measure_bias(gyro_rad, dt_s);
    return;
  }
  bias_.end_standstill();
  if (const std::optional<double> rate_rad_s = bias_.rate_rad_s()) {
    correct(gyro_rad, *rate_rad_s, interval, dt_s);
  }
}

// The angle was measured after the last period, and before the end of the next: halfway, with an
// error of half a period at most. The interval before it ends there, and the next one begins.
GyroHeading::Interval GyroHeading::end_interval() {
  const Interval half{0.5 * last_step_.wheels_rad, 0.5 * last_step_.predicted_rad,
                      0.5 * last_step_.path_m, 0};
  const Interval ended{since_.wheels_rad + half.wheels_rad,
                       since_.predicted_rad + half.predicted_rad, since_.path_m + half.path_m,
                       since_.periods};
  since_ = {-half.wheels_rad, -half.predicted_rad, -half.path_m, 0};
  return ended;
}

void GyroHeading::correct(double gyro_rad, double bias_rad_s, const Interval& interval,
                          double dt_s) {
  const double rotation_rad = gyro_rad - bias_rad_s * dt_s;
  doubt_.add({rotation_rad, interval.wheels_rad, interval.path_m}, dt_s);
  const bool is_frozen = gyro_rad == 0.0 && std::abs(interval.wheels_rad) > kRotatesRad &&
                         last_step_.wheels_rad != 0.0;
  if (is_frozen || doubt_.is_active()) {
    ++counts_.refused;
    use_ = is_frozen ? GyroUse::kFrozen : GyroUse::kDisagrees;
    slip_rad_per_m_ = 0.0;
    return;
  }
  ++counts_.used;
  use_ = GyroUse::kUsed;
  to_release_rad_ += rotation_rad - interval.predicted_rad;
  release_periods_ = kReleasePeriods;
  slip_rad_per_m_ =
      interval.path_m < kMinPathM ? 0.0 : (rotation_rad - interval.wheels_rad) / interval.path_m;
}

void GyroHeading::measure_bias(double gyro_rad, double dt_s) {
  slip_rad_per_m_ = 0.0;
  doubt_.forget_sums();
  switch (bias_.add_still(gyro_rad, dt_s)) {
    case GyroBias::Result::kMeasured:
      resume();
      break;
    case GyroBias::Result::kRunsOff:
      use_ = GyroUse::kRunsOff;
      break;
    case GyroBias::Result::kNothing:
      break;
  }
}

void GyroHeading::resume() {
  if (bias_.rate_rad_s()) {
    use_ = doubt_.is_active() ? GyroUse::kDisagrees : GyroUse::kUsed;
  } else {
    use_ = GyroUse::kUnsettled;
  }
}

void GyroHeading::interrupt() {
  forget_angle();
  since_ = {};
  last_step_ = {};
  to_release_rad_ = 0.0;
  release_periods_ = 0;
}

// The wheels alone, until the next two angles.
void GyroHeading::forget_angle() {
  last_angle_rad_.reset();
  slip_rad_per_m_ = 0.0;
  bias_.end_standstill();
}

}  // namespace nodmap::kurt
