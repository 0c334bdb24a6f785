// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/pitch_latency.hpp"

namespace nodmap::slam6d {
namespace {

// A change of more than this many standard deviations is due to a sill or a wrong match, not to
// latency.
constexpr double kMaxPitchDeviations = 3.0;

}  // namespace

void PitchLatency::learn(double rate_change_rad_s, double pitch_change_rad,
                         double pitch_change_variance) {
  const double innovation_variance =
      rate_change_rad_s * rate_change_rad_s * variance_ + pitch_change_variance;
  if (!(pitch_change_rad * pitch_change_rad <
        kMaxPitchDeviations * kMaxPitchDeviations * innovation_variance)) {
    return;
  }
  const double gain = variance_ * rate_change_rad_s / innovation_variance;
  seconds_ += gain * pitch_change_rad;
  variance_ -= gain * rate_change_rad_s * variance_;
}

}  // namespace nodmap::slam6d
