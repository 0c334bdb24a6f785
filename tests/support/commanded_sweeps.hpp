// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

namespace nodmap::test {

/// What the pitch controller commands at a speed, with the default parameters. Tests of other
/// modules nod with it; `sweep_plan_test` compares it with the pitch controller.
struct CommandedSweep {
  double forward_mps;
  double low_deg;   ///< lower end of the sweep
  double high_deg;  ///< its upper end
  double line_deg;  ///< greatest angle between neighbouring scans
};

inline constexpr std::array<CommandedSweep, 4> kCommandedSweeps{{{0.0, -60.0, 60.0, 1.65},
                                                                 {0.5, -50.4, 31.7, 1.87},
                                                                 {1.0, -30.0, 12.6, 1.49},
                                                                 {1.5, -21.4, 7.4, 0.91}}};

}  // namespace nodmap::test
