// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "drivers/laser3d/sick_command.hpp"

namespace nodmap::laser3d {

/// The mirror of the LMS2xx turns at 75 Hz, whatever is measured (Section II of the paper).
inline constexpr double kMirrorTurnUs = 13'320.0;
/// From one beam to the next of the same turn, which are always one degree apart.
inline constexpr double kMirrorDegreeUs = kMirrorTurnUs / 360.0;

/// The beams of one turn of the mirror: half a turn looks out, 6.66 ms for 180 degrees.
struct MirrorTurn {
  std::int64_t first_beam_us = 0;
  std::int64_t last_beam_us = 0;
  double angle_first_rad = 0.0;  ///< 0 ahead, positive to the left
  double angle_step_rad = 0.0;
  double range_max_m = 0.0;
  std::vector<float> ranges_m;
};

/// Takes a scan apart into the turns it was measured in. A scan of half a degree is two turns that
/// lie 13.32 ms apart, each with every second beam: on a laser that nods they belong to different
/// pitches. `sent_us` is when the sensor began to send it, which it does at the end of the (last)
/// half turn. An interlaced scan is one turn already.
[[nodiscard]] std::vector<MirrorTurn> mirror_turns(const SickScan& scan, SickVariant variant,
                                                   std::int64_t sent_us);
[[nodiscard]] MirrorTurn interlaced_turn(const SickScan& scan, std::int64_t sent_us);

}  // namespace nodmap::laser3d
