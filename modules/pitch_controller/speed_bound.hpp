// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/pitch_controller/params.hpp"
#include "modules/pitch_controller/unseen_places.hpp"
#include "modules/pitch_controller/virtual_corridor.hpp"

namespace nodmap::pitch_controller {

/// The sweeps to come, as the servo follows their plan.
struct ComingSweeps {
  ClearView view;
  NodMotion nod;
  double short_of_m = 0.0;  ///< the clear view begins this much farther ahead than planned
};

/// The greatest speed at which the robot can stop in time before any obstacle that the sweeps
/// detect, metres per second, >= 0. See README.md for why it is safe. At this speed v both hold:
///
/// 1. What comes into the clear view, F ahead, just after the laser has passed is measured R(F, v)
///    later (revisit_s()). It is still in the clear view then, and far enough away to react and
///    brake with half of the brakes' force:
///
///        F - v R(F, v) >= max(N, v T_processing + v^2 / 2a + margin)
///
/// 2. The robot may have been slower a moment ago, and its protected distance shorter. Since then
///    something may have appeared in places that the laser has not measured again yet. When the
///    laser measures such a place, the sweeps planned for v still meet it, and it is far enough
///    away to react and brake with all of the brakes' force. So a robot accelerates only as its
///    sweeps prove that nothing has appeared.
[[nodiscard]] double speed_bound(const ComingSweeps& sweeps, const UnseenPlaces& unseen,
                                 const VirtualCorridor& corridor, const robot::Braking& braking,
                                 const DetectionParams& detection);

/// Limits how fast the speed bound rises, as the base cannot follow any faster; it may fall at
/// once.
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
