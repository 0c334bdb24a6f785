// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "common/robot/robot_params.hpp"

namespace nodmap::map_server {

using robot::PitchInterval;

/// Derives from the pitches of the scans alone how the head nods: counts the sweeps, and keeps the
/// interval of pitches they cover. A head that is held still makes every scan a sweep.
class SweepTracker {
 public:
  void add(double pitch_first_rad, double pitch_last_rad);

  /// Counts up at each reversal of the head.
  [[nodiscard]] std::int64_t sweep() const { return sweep_; }

  /// The pitches covered by EACH of the last two complete sweeps; empty before. The smaller
  /// interval is the safe one: a point outside of it neither ages nor is removed. After the head
  /// has narrowed its sweeps one of them is still compared with the old interval; removal needs
  /// two.
  [[nodiscard]] std::optional<PitchInterval> covered() const;

 private:
  void finish_sweep(PitchInterval next);

  std::int64_t sweep_ = 0;
  int scans_ = 0;
  int still_scans_ = 0;  // for how many the pitch has stayed near still_rad_
  double still_rad_ = 0.0;
  double direction_ = 0.0;     // +1 up, -1 down, 0 not known yet
  double farthest_rad_ = 0.0;  // in this direction
  PitchInterval current_;
  std::optional<PitchInterval> last_;
  std::optional<PitchInterval> before_last_;
};

}  // namespace nodmap::map_server
