// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace nodmap::map_server {

struct PitchInterval {
  double low_rad = 0.0;
  double high_rad = 0.0;
};

/// Learns from the scans alone how the scanner nods: counts its passes from turning point to
/// turning point, and knows the wedge of pitches it looks through. A scanner that holds still makes
/// every scan a pass.
class SweepTracker {
 public:
  void add(double pitch_first_rad, double pitch_last_rad);

  /// Counts up at each turning point.
  [[nodiscard]] std::int64_t pass() const { return pass_; }

  /// The pitches seen in EACH of the last two finished passes; empty before. The smaller of two
  /// answers is the safe one: what is outside this wedge is neither aged nor taken for gone. When
  /// the scanner narrows its nod, one pass is still judged by the old wedge; removal needs two.
  [[nodiscard]] std::optional<PitchInterval> wedge() const;

 private:
  void finish_pass(PitchInterval next);

  std::int64_t pass_ = 0;
  int scans_ = 0;
  int still_scans_ = 0;        // how long the pitch has not left its surroundings
  double still_rad_ = 0.0;     // and where that is
  double direction_ = 0.0;     // +1 up, -1 down, 0 not known yet
  double farthest_rad_ = 0.0;  // in this direction
  PitchInterval current_;
  std::optional<PitchInterval> last_;
  std::optional<PitchInterval> before_last_;
};

}  // namespace nodmap::map_server
