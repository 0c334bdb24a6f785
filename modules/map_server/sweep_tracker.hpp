// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "common/robot/robot_params.hpp"

namespace nodmap::map_server {

using robot::PitchInterval;

/// Counts the sweeps of the head and keeps the pitch interval that they cover, from the pitches of
/// the scans alone. If the head is held still, every scan counts as a sweep.
class SweepTracker {
 public:
  /// `pitch_sigma_rad`: standard deviation of a scan's pitch. A head that noise alone seems to turn
  /// back has not reversed.
  explicit SweepTracker(double pitch_sigma_rad);

  /// Adds the pitches of the first and last beam of the next scan.
  void add(double pitch_first_rad, double pitch_last_rad);

  /// The number of the present sweep; increases at each reversal of the head.
  [[nodiscard]] std::int64_t sweep() const { return sweep_; }

  /// The pitches that BOTH of the last two complete sweeps have covered; empty before the second
  /// one. The intersection is the safe choice, because a point outside it neither ages nor is
  /// removed. When the head narrows its sweeps, one sweep is still compared with the old interval;
  /// that is harmless, because removal needs two sweeps.
  [[nodiscard]] std::optional<PitchInterval> covered() const;

 private:
  void finish_sweep(PitchInterval next);

  double reversed_rad_;   // the head has reversed when it has come back by more than this
  int most_still_scans_;  // the head is held still when its pitch stays within that for more scans
  std::int64_t sweep_ = 0;
  int scans_ = 0;
  int still_scans_ = 0;  // number of scans for which the pitch has stayed near still_rad_
  double still_rad_ = 0.0;
  double direction_ = 0.0;     // +1 up, -1 down, 0 unknown
  double farthest_rad_ = 0.0;  // in this direction
  PitchInterval current_;
  std::optional<PitchInterval> last_;
  std::optional<PitchInterval> before_last_;
};

}  // namespace nodmap::map_server
