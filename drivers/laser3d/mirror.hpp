// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::laser3d {

/// The mirror of the LMS2xx turns at 75 Hz, whatever is measured: Section II of the paper.
inline constexpr double kMirrorTurnUs = 13'320.0;
/// From one beam to the next of the same turn, one degree apart: half a turn takes 6.66 ms.
inline constexpr double kMirrorDegreeUs = kMirrorTurnUs / 360.0;

}  // namespace nodmap::laser3d
