// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/gyro_bias.hpp"

#include <cmath>

#include "common/geometry/angle.hpp"

namespace nodmap::kurt {
namespace {

using geometry::deg_to_rad;

constexpr double kWindowS = 1.0;
// How many windows in a row must show about the same rate before it is taken for the first bias,
// and for a new one: somebody may be turning the robot by hand.
constexpr int kFirstWindows = 2;
constexpr int kNewWindows = 5;
constexpr double kSameRateRadS = deg_to_rad(0.5);
// Beyond the noise, a bias changes by no more than this from one standstill to the next.
constexpr double kBiasStepRadS = deg_to_rad(0.1);

double squared(double x) {
  return x * x;
}

}  // namespace

GyroBias::Result GyroBias::add_still(double gyro_rad, double dt_s) {
  window_rad_ += gyro_rad;
  window_s_ += dt_s;
  if (window_s_ < kWindowS) {
    return Result::kNothing;
  }
  const Result result = take(window_rad_ / window_s_, window_s_);
  end_standstill();
  return result;
}

void GyroBias::end_standstill() {
  window_rad_ = 0.0;
  window_s_ = 0.0;
}

void GyroBias::age(double dt_s) {
  if (estimate_) {
    estimate_->age_s += dt_s;
  }
}

std::optional<double> GyroBias::rate_rad_s() const {
  return estimate_ ? std::optional(estimate_->rate_rad_s) : std::nullopt;
}

// The error of the bias acts all the time since it was measured, so the heading's error grows with
// the time, and its variance with the square of it.
double GyroBias::variance_rad2_per_s() const {
  const double age_s = estimate_->age_s;
  return 2.0 * estimate_->variance_rad2_s2 * age_s + squared(params_.bias_walk_rad_s * age_s);
}

GyroBias::Result GyroBias::take(double rate_rad_s, double dt_s) {
  const double variance = squared(params_.noise_rad) / dt_s;
  if (estimate_) {
    const double before =
        estimate_->variance_rad2_s2 + squared(params_.bias_walk_rad_s) * estimate_->age_s;
    if (std::abs(rate_rad_s - estimate_->rate_rad_s) <=
        4.0 * std::sqrt(before + variance) + kBiasStepRadS) {
      const double gain = before / (before + variance);
      *estimate_ = {estimate_->rate_rad_s + gain * (rate_rad_s - estimate_->rate_rad_s),
                    (1.0 - gain) * before, 0.0};
      odd_windows_ = 0;
      return Result::kMeasured;
    }
  }
  const bool is_same = std::abs(rate_rad_s - odd_rate_rad_s_) <= kSameRateRadS;
  odd_windows_ = odd_windows_ > 0 && is_same ? odd_windows_ + 1 : 1;
  odd_rate_rad_s_ = rate_rad_s;
  if (odd_windows_ < (estimate_ ? kNewWindows : kFirstWindows)) {
    return Result::kNothing;
  }
  odd_windows_ = 0;
  if (std::abs(rate_rad_s) > params_.max_bias_rad_s) {
    estimate_.reset();
    return Result::kRunsOff;
  }
  estimate_ = Estimate{rate_rad_s, variance, 0.0};
  return Result::kMeasured;
}

}  // namespace nodmap::kurt
