// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "common/geometry/time.hpp"
#include "modules/pitch_controller/sweep_plan.hpp"

namespace nodmap::pitch_controller {

/// What the navigator does on the arc that it has chosen.
enum class OnArc : std::uint8_t {
  kDrives,  ///< limits and bends alone decide how fast
  kSlowed,  ///< obstacles, ground that was not seen, or somebody
  kElse,    ///< it rotates, backs up or stands
};

/// What the navigator says of the arc that it has chosen, as in NAVIGATION.
struct ChosenArc {
  time::Timestamp stamp{};
  OnArc does = OnArc::kElse;
  double free_m = 0.0;           ///< ahead of the front until the first contact; may be infinite
  double max_forward_mps = 0.0;  ///< the speed that it may drive there now
};

/// What the robot needs to see on its chosen arc. `bound_mps` is the speed bound that the navigator
/// has used, `present_mps` the robot's speed.
///
/// - If the bound alone keeps the robot slow, it need not see beyond the first obstacle, and the
///   sweeps may be shorter.
/// - If something slows it down although the first obstacle is far enough ahead for the bound, it
///   is likely ground that it has not seen: it looks down to where it could just stop.
[[nodiscard]] NeededView needed_view(const ChosenArc& arc, double present_mps, double bound_mps,
                                     const robot::Braking& braking, double processing_s);

}  // namespace nodmap::pitch_controller
