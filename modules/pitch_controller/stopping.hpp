// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/pitch_controller/params.hpp"

namespace nodmap::pitch_controller {

/// How the robot comes to stand before what it finds: it goes on for the time of reaction, then
/// brakes evenly. Trusting the brakes with half of what the base is commanded to do leaves the
/// other half for slope, load and smooth floors.
struct Stopping {
  double deceleration_mps2;
  double processing_s;
  double margin_m;

  [[nodiscard]] static Stopping of(const PitchControllerParams& params);

  /// T_w = 2 T_h + T_proc: at its ends the nod looks at a place once in two sweeps only.
  [[nodiscard]] double reaction_s(double sweep_s) const;

  /// v T_w + v^2 / 2a + margin, metres.
  [[nodiscard]] double way_m(double forward_mps, double reaction_s) const;

  /// The speed whose way_m() is `way_m`; 0 where the margin alone is longer.
  [[nodiscard]] double speed_mps(double way_m, double reaction_s) const;
};

}  // namespace nodmap::pitch_controller
