// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/sweep_regulator.hpp"

#include <algorithm>

namespace nodmap::pitch_controller {
namespace {

// A servo that is off by more than this is broken, not mistuned; and one odd sweep is no reason for
// a jump.
constexpr double kMostTrim = 0.5;
constexpr double kMostError = 0.5;

}  // namespace

void SweepRegulator::add(double wished_s, double measured_s) {
  error_ = std::clamp((wished_s - measured_s) / wished_s, -kMostError, kMostError);
  // Anti-windup: what the servo cannot do is not asked for ever more loudly.
  const bool beyond =
      (limit_ == Limit::kFastest && error_ < 0.0) || (limit_ == Limit::kSlowest && error_ > 0.0);
  if (!beyond) {
    integral_ = std::clamp(integral_ + i_ * error_, -kMostTrim, kMostTrim);
  }
}

double SweepRegulator::command_s(double wished_s, double fastest_s, double slowest_s) {
  const double trim = std::clamp(p_ * error_ + integral_, -kMostTrim, kMostTrim);
  const double command_s = wished_s * (1.0 + trim);
  limit_ = command_s < fastest_s   ? Limit::kFastest
           : command_s > slowest_s ? Limit::kSlowest
                                   : Limit::kNone;
  return std::clamp(command_s, fastest_s, slowest_s);
}

}  // namespace nodmap::pitch_controller
