// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/stopping.hpp"

#include "common/robot/stopping.hpp"

namespace nodmap::pitch_controller {

Stopping Stopping::of(const PitchControllerParams& params) {
  return {params.robot.braking.deceleration_mps2, params.processing_s,
          params.robot.braking.stop_margin_m};
}

double Stopping::reaction_s(double sweep_s) const {
  return 2.0 * sweep_s + processing_s;
}

double Stopping::way_m(double forward_mps, double reaction_s) const {
  return robot::stopping_distance(forward_mps, reaction_s, deceleration_mps2) + margin_m;
}

double Stopping::speed_mps(double way_m, double reaction_s) const {
  return robot::stoppable_speed(way_m - margin_m, reaction_s, deceleration_mps2);
}

}  // namespace nodmap::pitch_controller
