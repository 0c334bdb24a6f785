// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/mirror.hpp"

#include <cmath>

#include "common/geometry/angle.hpp"

namespace nodmap::laser3d {
namespace {

/// Every `stride`-th range from `first` on, measured in the half turn that ended at
/// `half_turn_end_us`; `from_right_deg` is the angle of the first of them, 0 to the right.
MirrorTurn turn_of(const SickScan& scan, std::size_t first, std::size_t stride,
                   double from_right_deg, double half_turn_end_us) {
  MirrorTurn turn;
  for (std::size_t i = first; i < scan.ranges_m.size(); i += stride) {
    turn.ranges_m.push_back(scan.ranges_m[i]);
  }
  const double begin_us = half_turn_end_us - (180.0 - from_right_deg) * kMirrorDegreeUs;
  const auto beams = static_cast<double>(turn.ranges_m.size());
  turn.first_beam_us = std::llround(begin_us);
  turn.last_beam_us = std::llround(begin_us + (beams - 1.0) * kMirrorDegreeUs);
  turn.angle_first_rad = geometry::deg_to_rad(from_right_deg - 90.0);
  turn.angle_step_rad = geometry::deg_to_rad(1.0);
  turn.range_max_m = scan.range_max_m;
  return turn;
}

}  // namespace

std::vector<MirrorTurn> mirror_turns(const SickScan& scan, SickVariant variant,
                                     std::int64_t sent_us) {
  const SickGeometry geometry = geometry_of(variant);
  std::vector<MirrorTurn> turns;
  for (int k = 0; k < geometry.turns; ++k) {
    const double first_deg = 90.0 - 0.5 * geometry.field_deg + 0.01 * geometry.resolution_cdeg * k;
    const double end_us = static_cast<double>(sent_us) - (geometry.turns - 1 - k) * kMirrorTurnUs;
    turns.push_back(turn_of(scan, static_cast<std::size_t>(k),
                            static_cast<std::size_t>(geometry.turns), first_deg, end_us));
  }
  return turns;
}

MirrorTurn interlaced_turn(const SickScan& scan, std::int64_t sent_us) {
  const double first_deg = 0.25 * scan.quarter.value_or(0);
  return turn_of(scan, 0, 1, first_deg, static_cast<double>(sent_us));
}

}  // namespace nodmap::laser3d
