// SPDX-License-Identifier: BSD-3-Clause
#include "bench/live/stop_metrics.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::bench {
namespace {

constexpr double kStationaryMps = 0.02;  // one encoder tick in 10 ms is 0.002 m/s
constexpr double kStationaryRadS = 0.05;

bool is_stationary(const Motion& motion) {
  return std::abs(motion.forward_mps) < kStationaryMps &&
         std::abs(motion.yaw_rate_rad_s) < kStationaryRadS;
}

}  // namespace

std::optional<StopMetrics> stop_metrics(const std::vector<Motion>& motions, time::Timestamp from) {
  auto at = std::ranges::lower_bound(motions, from, {}, &Motion::stamp);
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
  stop.time_s = time::seconds(at->stamp - from);
  return stop;
}

}  // namespace nodmap::bench
