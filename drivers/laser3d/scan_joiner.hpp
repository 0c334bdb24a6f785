// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "drivers/laser3d/mirror.hpp"
#include "drivers/laser3d/servo_session.hpp"

namespace nodmap::laser3d {

struct JoinerSettings {
  std::int64_t max_extrapolation_us = 10'000;  ///< beyond the newest sample
  std::int64_t max_gap_us = 60'000;            ///< between two samples to interpolate between
  std::int64_t patience_us = 30'000;  ///< how long a turn waits for a sample after its last beam
};

/// A turn of the mirror with the pitch at both its ends.
struct PitchedTurn {
  MirrorTurn turn;
  double pitch_first_rad = 0.0;
  double pitch_last_rad = 0.0;
};

/// Brings the two streams together: for each turn of the mirror the pitch at its first and last
/// beam, interpolated between samples of the servo. A turn whose pitch is not known is dropped: a
/// scan at the wrong pitch is worse than none.
class ScanJoiner {
 public:
  explicit ScanJoiner(const JoinerSettings& settings = {}) : settings_(settings) {}

  /// Samples that step back in time are dropped.
  void add(const PitchSample& sample);
  void add(MirrorTurn turn);

  /// The next turn that can be joined, in order. Empty when there is none (yet).
  [[nodiscard]] std::optional<PitchedTurn> next(std::int64_t now_us);

  /// The pitch at a time; empty when no sample is near enough.
  [[nodiscard]] std::optional<double> pitch_at(std::int64_t time_us) const;

  /// Forgets the samples: the servo is gone.
  void forget_pitch() { samples_.clear(); }

  /// Turns dropped because their pitch was not known.
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

 private:
  JoinerSettings settings_;
  std::deque<PitchSample> samples_;  // strictly increasing times
  std::deque<MirrorTurn> waiting_;
  std::int64_t dropped_ = 0;
};

}  // namespace nodmap::laser3d
