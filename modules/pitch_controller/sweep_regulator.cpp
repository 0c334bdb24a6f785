// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/sweep_regulator.hpp"

#include <algorithm>

namespace nodmap::pitch_controller {
namespace {

// A servo that deviates by more than this is broken, not mistuned. The limit also prevents a jump
// after a single unusual sweep.
constexpr double kMaxTrim = 0.5;
constexpr double kMaxError = 0.5;

}  // namespace

void SweepRegulator::add(double wanted_s, double measured_s) {
  error_ = std::clamp((wanted_s - measured_s) / wanted_s, -kMaxError, kMaxError);
  // Anti-windup: at the limit of the servo the integral does not grow beyond the limit.
  const bool beyond =
      (limit_ == Limit::kFastest && error_ < 0.0) || (limit_ == Limit::kSlowest && error_ > 0.0);
  if (!beyond) {
    integral_ = std::clamp(integral_ + gains_.i * error_, -kMaxTrim, kMaxTrim);
  }
}

double SweepRegulator::command_s(double wanted_s, double fastest_s, double slowest_s) {
  const double trim = std::clamp(gains_.p * error_ + integral_, -kMaxTrim, kMaxTrim);
  const double command_s = wanted_s * (1.0 + trim);
  limit_ = command_s < fastest_s   ? Limit::kFastest
           : command_s > slowest_s ? Limit::kSlowest
                                   : Limit::kNone;
  return std::clamp(command_s, fastest_s, slowest_s);
}

}  // namespace nodmap::pitch_controller
