// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/proximity.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "common/geometry/angle.hpp"
#include "modules/navigator/local_map/local_map.hpp"

namespace nodmap::navigator {
namespace {

using geometry::deg_to_rad;

/// In base, in the order of base_sensors_t; it looks along x.
const std::array<geometry::SE2, Proximity::kSensors> kMounts{{{0.203, 0.153, deg_to_rad(45.0)},
                                                              {0.0, 0.165, deg_to_rad(90.0)},
                                                              {-0.203, 0.153, deg_to_rad(135.0)},
                                                              {-0.217, 0.0, deg_to_rad(180.0)},
                                                              {-0.203, -0.153, deg_to_rad(-135.0)},
                                                              {0.0, -0.165, deg_to_rad(-90.0)},
                                                              {0.203, -0.153, deg_to_rad(-45.0)}}};
/// No such range finder sees farther; a message may say anything.
constexpr double kFarthestM = 2.0;
/// So near to what the local map has it is the same: the sensor's error, and a map that odometry
/// has moved.
constexpr double kSameM = 0.2;
/// What does not move by more within such a time stands. Who comes at 0.1 m/s moves more.
constexpr double kStandsM = 0.05;
constexpr time::Duration kStands = 600ms;
/// Once the robot has moved, what it sees this near to something stationary is the same: of a wall
/// that the laser did not see the sensors see one place after the other.
constexpr double kSameThingM = 0.3;
constexpr time::Duration kRemembered = 10s;
constexpr double kMovedM = 0.02;
constexpr double kMovedRad = 0.05;
constexpr time::Duration kHold = 500ms;

/// The laser saw floor at a place, and nothing that stands is near it.
bool is_free(const Eigen::Vector2d& p_odom, const LocalMap& map) {
  const double cell_m = map.grid().cell_size_m();
  const int reach = static_cast<int>(kSameM / cell_m);
  for (int dx = -reach; dx <= reach; ++dx) {
    for (int dy = -reach; dy <= reach; ++dy) {
      const Eigen::Vector2d beside = p_odom + cell_m * Eigen::Vector2d(dx, dy);
      if (dx * dx + dy * dy <= reach * reach && map.is_blocked_at(beside)) {
        return false;
      }
    }
  }
  return map.is_seen_floor(p_odom);
}

}  // namespace

void Proximity::add(time::Timestamp stamp, const Ranges& ranges_m, const geometry::SE2& T_odom_base,
                    const LocalMap& local_map) {
  for (std::size_t i = 0; i < kSensors; ++i) {
    std::optional<Stranger>& stranger = strangers_[i];
    if (!(ranges_m[i] >= 0.0 && ranges_m[i] <= kFarthestM)) {  // NaN, too
      stranger.reset();
      continue;
    }
    const Eigen::Vector2d p_odom = T_odom_base * (kMounts[i] * Eigen::Vector2d(ranges_m[i], 0.0));
    if (!is_free(p_odom, local_map) || was_stationary_there(stamp, p_odom, T_odom_base)) {
      stranger.reset();
    } else if (!stranger || (stranger->p_odom - p_odom).norm() > kStandsM) {
      stranger = {p_odom, stamp};
    }
    if (stranger && std::chrono::abs(stamp - stranger->since) < kStands) {
      detected_at_ = stamp;
    } else if (stranger) {
      remember({stranger->p_odom, T_odom_base, stamp});
    }
  }
}

bool Proximity::was_stationary_there(time::Timestamp stamp, const Eigen::Vector2d& p_odom,
                                     const geometry::SE2& T_odom_base) const {
  return std::ranges::any_of(standing_, [&](const Standing& standing) {
    const geometry::SE2 moved = standing.T_odom_base.inverse() * T_odom_base;
    return std::chrono::abs(stamp - standing.seen) < kRemembered &&
           (standing.p_odom - p_odom).norm() < kSameThingM &&
           (moved.translation().norm() > kMovedM || std::abs(moved.yaw) > kMovedRad);
  });
}

void Proximity::remember(const Standing& standing) {
  std::erase_if(standing_, [&](const Standing& other) {
    return std::chrono::abs(standing.seen - other.seen) >= kRemembered;
  });
  const auto same = std::ranges::find_if(standing_, [&](const Standing& other) {
    return (other.p_odom - standing.p_odom).norm() < kStandsM;
  });
  if (same == standing_.end()) {
    standing_.push_back(standing);
  } else {
    same->seen = standing.seen;  // where the robot was when it was found to stand counts
  }
}

bool Proximity::is_detected(time::Timestamp stamp) const {
  // A stamp that stepped back must not prolong the wait.
  return detected_at_ && std::chrono::abs(stamp - *detected_at_) < kHold;
}

}  // namespace nodmap::navigator
