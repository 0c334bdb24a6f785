// SPDX-License-Identifier: BSD-3-Clause
#include "bench/live/stop_metrics.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::bench {
namespace {

constexpr double kStationaryMps = 0.02;  // an encoder's tick in 10 ms is 0.002 m/s
constexpr double kStationaryRadS = 0.05;

bool is_stationary(const Motion& motion) {
  return std::abs(motion.forward_mps) < kStationaryMps &&
         std::abs(motion.yaw_rate_rad_s) < kStationaryRadS;
}

}  // namespace

std::optional<StopMetrics> stop_metrics(const std::vector<Motion>& motions, std::int64_t from_us) {
  auto at = std::ranges::lower_bound(motions, from_us, {}, &Motion::utime_us);
  if (at == motions.end()) {
    return std::nullopt;
  }
  StopMetrics stop{.speed_mps = std::abs(at->forward_mps)};
  for (; at != motions.end() && !is_stationary(*at); ++at) {
    const auto next = std::next(at);
    if (next != motions.end()) {
      stop.distance_m += std::hypot(next->x_m - at->x_m, next->y_m - at->y_m);
    }
  }
  if (at == motions.end()) {
    return std::nullopt;
  }
  stop.time_s = 1e-6 * static_cast<double>(at->utime_us - from_us);
  return stop;
}

}  // namespace nodmap::bench
