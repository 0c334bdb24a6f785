// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/pitch_controller/params.hpp"
#include "modules/pitch_controller/virtual_corridor.hpp"

namespace nodmap::pitch_controller {

/// The greatest speed at which the robot can stop in time before any obstacle that the sweeps
/// detect, metres per second, >= 0. `sweep_s` is the duration of the longest sweep.
///
/// In the worst case an obstacle appears at the far end of the clear view just after the laser has
/// passed. The laser hits it one period (two sweeps) later, unless the robot has moved so far that
/// the obstacle is no longer in the clear view. The remaining distance must suffice to react and
/// brake.
[[nodiscard]] double speed_bound(const ClearView& view, double sweep_s,
                                 const robot::Braking& braking, const DetectionParams& detection);

/// Limits how fast the speed bound rises; it may fall at once. An obstacle that appeared while the
/// robot was slower may be at the end of a shorter required distance, and the laser may not have
/// seen it yet. appearing_obstacle_test checks this by brute force for the default rise; it does
/// not show which rise would be too fast.
class RisingBound {
 public:
  explicit RisingBound(double acceleration_mps2) : acceleration_mps2_(acceleration_mps2) {}

  /// Returns `bound_mps`, limited to a rise of `acceleration_mps2` since the last call, `dt_s` ago,
  /// and to 0.2 m/s above the present speed.
  double limit(double bound_mps, double present_mps, double dt_s);

 private:
  double acceleration_mps2_;
  double told_mps_ = 0.0;
};

}  // namespace nodmap::pitch_controller
