// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/odometry_scatter.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::slam6d {
namespace {

// Older motions count less, because floors and loads change.
constexpr double kMaxMotions = 40.0;

}  // namespace

void OdometryScatter::learn(const MotionEvidence& forward, double variance_m2) {
  const double gain =
      (forward.prior_variance - forward.posterior_variance) / forward.prior_variance;
  if (!(gain > kMinGain)) {
    return;
  }
  // The estimate is a weighted mean of prediction and measurement. This recovers the measurement.
  // Its own variance is not subtracted, so that the scatter is overestimated rather than
  // underestimated.
  const double deviation_m = forward.deviation / gain;
  const double measured_m2 = forward.posterior_variance / gain;
  const double weight = variance_m2 / (variance_m2 + measured_m2);
  square_ =
      (motions_ * square_ + weight * deviation_m * deviation_m / variance_m2) / (motions_ + weight);
  motions_ = std::min(motions_ + weight, kMaxMotions);
}

double OdometryScatter::factor() const {
  return std::clamp(std::sqrt(square_), least_, 1.0);
}

}  // namespace nodmap::slam6d
