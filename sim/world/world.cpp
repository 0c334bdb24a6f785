// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/world.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::sim {

bool Actor::is_present(double time_s) const {
  return time_s >= appear_s && time_s < vanish_s;
}

double Actor::time_in_round(double time_s) const {
  const double first_s = path.front().time_s;
  const double round_s = path.back().time_s - first_s;
  return loop && round_s > 0.0 && time_s > first_s ? first_s + std::fmod(time_s - first_s, round_s)
                                                   : time_s;
}

Eigen::Vector2d Actor::position(double time_s) const {
  if (path.empty()) {
    return Eigen::Vector2d::Zero();
  }
  const double t = time_in_round(time_s);
  const auto after = std::ranges::upper_bound(path, t, {}, &Waypoint::time_s);
  if (after == path.begin()) {
    return path.front().position;
  }
  if (after == path.end()) {
    return path.back().position;
  }
  const Waypoint& from = *std::prev(after);
  const double fraction = (t - from.time_s) / (after->time_s - from.time_s);
  return from.position + fraction * (after->position - from.position);
}

}  // namespace nodmap::sim
