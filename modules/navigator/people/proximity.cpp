// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/proximity.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "common/geometry/whole_steps.hpp"
#include "modules/navigator/local_map/local_map.hpp"

namespace nodmap::navigator {
namespace {

// A reading this near to an obstacle of the local map is that obstacle: error of the sensor and
// drift of odometry.
constexpr double kSameM = 0.2;
// A reading this near to a track is the tracked person; the track's own error adds to it, at most
// kMaxTrackErrorM. Something that moves less than kStandsM in kStands is stationary: at 0.1 m/s
// it would move more.
constexpr double kSameTrackM = 0.15;
constexpr double kMaxTrackErrorM = 0.3;
constexpr double kStandsM = 0.05;
constexpr time::Duration kStands = 600ms;
constexpr time::Duration kHold = 500ms;
// The sensors measure this far; without a reading nothing is nearer.
constexpr double kSensorReachM = 0.5;
// Half the width of whatever stands: a foot is 0.3 m long.
constexpr double kStandingHalfWidthM = 0.15;
constexpr double kPointSpacingM = 0.025;
// Half the width of a sensor's cone where it ends.
constexpr double kConeM = 0.05;
// What stands farther away than this is left to the laser.
constexpr double kForgottenM = 1.0;

// An obstacle may still be there although the map has forgotten it because odometry has drifted.
bool may_stand(const LocalCell* cell) {
  return cell != nullptr && (cell->is_obstacle() || cell->is_hole());
}

// Whether the laser saw floor at a place, and no obstacle near it.
bool is_free(const Eigen::Vector2d& p_odom, const LocalMap& map) {
  const double cell_m = map.grid().cell_size_m();
  const int reach = geometry::whole_steps(kSameM, cell_m);
  for (int dx = -reach; dx <= reach; ++dx) {
    for (int dy = -reach; dy <= reach; ++dy) {
      const Eigen::Vector2d beside = p_odom + cell_m * Eigen::Vector2d(dx, dy);
      if (dx * dx + dy * dy <= reach * reach && may_stand(map.cell_at(beside))) {
        return false;
      }
    }
  }
  return map.is_only_seen_floor(p_odom);
}

// Whether a reading is on a tracked person, within the track's error.
bool is_tracked(const Eigen::Vector2d& p_odom, const People& people_odom) {
  return std::ranges::any_of(people_odom, [&](const Person& person) {
    const double error_m = std::min(kMaxTrackErrorM, 2.0 * person.position_sigma_m);
    return (p_odom - person.position).norm() < person.radius_m + kSameTrackM + error_m;
  });
}

}  // namespace

void Proximity::add(time::Timestamp stamp, const Ranges& ranges_m, const geometry::SE2& T_odom_base,
                    const LocalMap& local_map, const People& people_odom) {
  forget_far_places(T_odom_base);
  for (std::size_t i = 0; i < robot::kInfraredCount; ++i) {
    std::optional<Stranger>& stranger = strangers_[i];
    const geometry::SE2 T_odom_sensor = T_odom_base * robot::kInfraredMounts[i];
    forget_places_before(T_odom_sensor, ranges_m[i]);
    if (!is_reading(ranges_m[i])) {
      stranger.reset();
      continue;
    }
    const geometry::SE2 T_odom_there = T_odom_sensor * geometry::SE2{ranges_m[i], 0.0, 0.0};
    const Eigen::Vector2d p_odom = T_odom_there.translation();
    if (!is_free(p_odom, local_map) || is_tracked(p_odom, people_odom)) {
      stranger.reset();
    } else if (!stranger || (stranger->p_odom - p_odom).norm() > kStandsM) {
      stranger = {p_odom, stamp};
    }
    if (stranger && std::chrono::abs(stamp - stranger->since) < kStands) {
      detected_at_ = stamp;
    } else if (stranger) {
      standing_[i] = T_odom_there;
    }
  }
}

void Proximity::forget_far_places(const geometry::SE2& T_odom_base) {
  for (std::optional<geometry::SE2>& place : standing_) {
    if (place && (place->translation() - T_odom_base.translation()).norm() > kForgottenM) {
      place.reset();
    }
  }
}

// A sensor that measures something farther away has looked through the places before it. NaN: it
// has not looked, so what it has measured may still be there.
void Proximity::forget_places_before(const geometry::SE2& T_odom_sensor, double range_m) {
  if (std::isnan(range_m)) {
    return;
  }
  const double looked_m = is_reading(range_m) ? range_m : kSensorReachM;
  for (std::optional<geometry::SE2>& place : standing_) {
    if (!place) {
      continue;
    }
    const Eigen::Vector2d p = T_odom_sensor.inverse() * place->translation();
    const bool is_gone =
        p.x() > -kStandsM && p.x() < looked_m - kStandsM && std::abs(p.y()) < kConeM;
    if (is_gone) {
      place.reset();
    }
  }
}

Points Proximity::points_base(const geometry::SE2& T_odom_base) const {
  Points points;
  for (const std::optional<geometry::SE2>& place : standing_) {
    if (place) {
      const geometry::SE2 T_base_place = T_odom_base.inverse() * *place;
      for (double y = -kStandingHalfWidthM; y < kStandingHalfWidthM + 0.5 * kPointSpacingM;
           y += kPointSpacingM) {
        points.push_back(T_base_place * Eigen::Vector2d(0.0, y));
      }
    }
  }
  return points;
}

bool Proximity::is_detected(time::Timestamp stamp) const {
  // abs(): a stamp that stepped back must not prolong the wait.
  return detected_at_ && std::chrono::abs(stamp - *detected_at_) < kHold;
}

}  // namespace nodmap::navigator
