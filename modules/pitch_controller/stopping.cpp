// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/stopping.hpp"

#include <cmath>

namespace nodmap::pitch_controller {

Stopping Stopping::of(const PitchControllerParams& params) {
  return {params.deceleration_mps2, params.processing_s, params.stop_margin_m};
}

double Stopping::reaction_s(double sweep_s) const {
  return 2.0 * sweep_s + processing_s;
}

double Stopping::way_m(double forward_mps, double reaction_s) const {
  return forward_mps * reaction_s + forward_mps * forward_mps / (2.0 * deceleration_mps2) +
         margin_m;
}

double Stopping::speed_mps(double way_m, double reaction_s) const {
  const double free_m = way_m - margin_m;
  if (!(free_m > 0.0)) {
    return 0.0;
  }
  const double lost_mps = deceleration_mps2 * reaction_s;
  return -lost_mps + std::sqrt(lost_mps * lost_mps + 2.0 * deceleration_mps2 * free_m);
}

}  // namespace nodmap::pitch_controller
