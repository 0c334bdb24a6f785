// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "common/geometry/time.hpp"
#include "drivers/laser3d/servo/session.hpp"
#include "drivers/laser3d/sick/scan.hpp"

namespace nodmap::laser3d {

struct JoinerParams {
  double max_extrapolation_s = 0.010;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("max_extrapolation_s", max_extrapolation_s, {0.0, 0.1},
             "How far beyond the newest servo reading the pitch is extrapolated.");
  }
};

/// A mirror revolution with the pitch at its first and at its last beam.
struct PitchedRevolution {
  MirrorRevolution revolution;
  double pitch_first_rad = 0.0;
  double pitch_last_rad = 0.0;
};

/// Joins the two streams: gives each mirror revolution the pitch at its first and last beam,
/// interpolated between the servo's samples. A revolution with unknown pitch is dropped, because a
/// scan with a wrong pitch is worse than none.
class ScanJoiner {
 public:
  explicit ScanJoiner(const JoinerParams& params = {}) : params_(params) {}

  /// Samples that step back in time are dropped.
  void add(const PitchSample& sample);
  void add(MirrorRevolution revolution);

  /// The next revolution whose pitch is known, in order; empty if there is none yet.
  [[nodiscard]] std::optional<PitchedRevolution> next(time::SteadyTime now);

  /// The pitch at a time, rad; empty if no sample is near enough.
  [[nodiscard]] std::optional<double> pitch_at(time::SteadyTime stamp) const;

  /// Forgets all samples, because the servo is gone.
  void forget_pitch() { samples_.clear(); }

  /// Number of revolutions dropped because their pitch was unknown.
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

 private:
  JoinerParams params_;
  std::deque<PitchSample> samples_;  // strictly increasing times
  std::deque<MirrorRevolution> waiting_;
  std::int64_t dropped_ = 0;
};

}  // namespace nodmap::laser3d
