// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/speed_bound.hpp"

#include <algorithm>

namespace nodmap::pitch_controller {
namespace {

// Allows for the lag of the wheels behind the command.
constexpr double kHeadroomMps = 0.2;

}  // namespace

double speed_bound(const ClearView& view, double sweep_s, const robot::Braking& braking,
                   const DetectionParams& detection) {
  if (!(view.far_m > view.near_m) || !(sweep_s > 0.0)) {
    return 0.0;
  }
  return std::min(braking.permitted_mps(view.far_m, detection.reaction_s(sweep_s)),
                  (view.far_m - view.near_m) / (2.0 * sweep_s));
}

double RisingBound::limit(double bound_mps, double present_mps, double dt_s) {
  const double from_mps = std::max(told_mps_, present_mps);
  told_mps_ =
      std::min({bound_mps, from_mps + acceleration_mps2_ * dt_s, present_mps + kHeadroomMps});
  return told_mps_;
}

}  // namespace nodmap::pitch_controller
