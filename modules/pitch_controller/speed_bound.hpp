// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/pitch_controller/params.hpp"
#include "modules/pitch_controller/virtual_corridor.hpp"

namespace nodmap::pitch_controller {

/// The speed up to which the robot stops in time before whatever the sweeps find, metres per
/// second, >= 0. `sweep_s` is the duration of the longest of them.
///
/// In the worst case an obstacle appears at the far end of the clear view just after the laser has
/// passed there. It is hit one period, two sweeps, later, if by then the robot has not carried its
/// view past it; the distance that is left then must suffice for reaction and braking.
[[nodiscard]] double speed_bound(const ClearView& view, double sweep_s,
                                 const robot::Braking& braking, const DetectionParams& detection);

/// Lets the bound that driving is told fall at once, but rise slowly. What appeared while the robot
/// was slower did so at the end of a shorter stopping distance, and may not have been looked at
/// since: accelerating no faster than this over a period of the nod, the robot can still stop
/// before it, with the full force of the brakes.
class RisingBound {
 public:
  explicit RisingBound(double acceleration_mps2) : acceleration_mps2_(acceleration_mps2) {}

  /// The bound to be told now: `bound_mps`, if it has not risen too fast since `dt_s` ago, and no
  /// more than 0.2 m/s above the present speed.
  double limit(double bound_mps, double present_mps, double dt_s);

 private:
  double acceleration_mps2_;
  double told_mps_ = 0.0;
};

}  // namespace nodmap::pitch_controller
