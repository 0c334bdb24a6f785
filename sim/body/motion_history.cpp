// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/motion_history.hpp"

#include <algorithm>

namespace nodmap::sim {

geometry::SE3 Moment::T_world_base() const {
  // Within a millisecond the chord is as accurate as the arc.
  const Eigen::Vector4d q = from_.orientation.coeffs() +
                            fraction_ * (to_.orientation.coeffs() - from_.orientation.coeffs());
  return geometry::make_se3(from_.position + fraction_ * (to_.position - from_.position),
                            Eigen::Quaterniond(q).normalized());
}

PitchState Moment::pitch() const {
  return {interpolate(from_.pitch.pitch_rad, to_.pitch.pitch_rad),
          interpolate(from_.pitch.rate_rad_s, to_.pitch.rate_rad_s)};
}

WheelTravel Moment::travel() const {
  return {interpolate(from_.travel.left_m, to_.travel.left_m),
          interpolate(from_.travel.right_m, to_.travel.right_m)};
}

Step& MotionHistory::add(time::SteadyTime instant) {
  newest_ = instant;
  Step& step = steps_[index(instant)];
  step.instant = instant;
  return step;
}

Moment MotionHistory::at(time::SteadyTime instant) const {
  const time::SteadyTime after = std::min(newest_, time::SteadyTime((number(instant) + 1) * kStep));
  const Step& to = steps_[index(after)];
  const Step& from = after > time::SteadyTime{} ? steps_[index(after - kStep)] : to;
  const double fraction = 1e-3 * time::FineDuration(instant - from.instant).count();
  return {from, to, fraction};
}

}  // namespace nodmap::sim
