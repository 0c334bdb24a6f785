// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/params.hpp"

#include "common/params/params.hpp"

namespace nodmap::navigator {

void check(const NavigatorParams& params) {
  const robot::Braking& braking = params.robot.braking;
  if (braking.emergency_deceleration_mps2 < braking.deceleration_mps2) {
    throw params::ParamError(
        "robot.braking.emergency_deceleration_mps2: is below robot.braking.deceleration_mps2");
  }
  if (params.drive.creep_margin_m > params.drive.side_margin_m) {
    throw params::ParamError("drive.creep_margin_m: is above drive.side_margin_m");
  }
}

}  // namespace nodmap::navigator
