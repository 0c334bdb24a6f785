// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/gait.hpp"

#include <cmath>

#include "common/geometry/angle.hpp"

namespace nodmap::sim {
namespace {

// Of an adult who walks (Winter, Biomechanics and Motor Control of Human Movement): two steps of
// 0.7 m, feet 0.2 m apart. At half the height of the hip a leg swings half as far as its foot.
constexpr double kStrideM = 1.4;
constexpr double kSwingM = 0.18;
constexpr double kAsideM = 0.1;
// An actor that is farther away a millisecond later has begun its round anew.
constexpr double kLongestStepM = 0.1;

}  // namespace

void Gait::move_to(const Eigen::Vector2d& position) {
  const Eigen::Vector2d step = position - position_;
  const double step_m = step.norm();
  position_ = position;
  if (step_m > 0.0 && step_m < kLongestStepM) {
    walked_m_ += step_m;
    heading_ = step / step_m;
  }
}

Legs Gait::legs() const {
  const Eigen::Vector2d ahead =
      kSwingM * std::sin(2.0 * geometry::kPi * walked_m_ / kStrideM) * heading_;
  const Eigen::Vector2d left = kAsideM * Eigen::Vector2d(-heading_.y(), heading_.x());
  return {position_ + left + ahead, position_ - left - ahead};
}

}  // namespace nodmap::sim
