// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/navigator/goal.hpp"
#include "modules/navigator/obstacle_points.hpp"
#include "modules/navigator/people/person.hpp"
#include "modules/navigator/surroundings/seen_directions.hpp"

namespace nodmap::navigator {

class Geofence;
class LocalMap;
class Map2d;
class RearView;
class Trail;

/// Everything that a decision depends on. Inputs::situation() makes one of the newest messages;
/// Surroundings::complete() then adds what the scans have shown.
struct Situation {
  time::Timestamp stamp{};
  geometry::SE2 T_odom_base;  ///< now
  geometry::SE2 T_map_odom;   ///< by 2D SLAM; identity without it
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
  double max_forward_mps = 0.0;  ///< speed bound of the pitch controller
  std::int64_t sweep_count = 0;  ///< reversals of the head
  bool laser_is_held = false;    ///< it does not nod, so waiting brings nothing new into view
  std::optional<GoalInBase> goal;
  const Geofence* geofence = nullptr;  ///< null: none
  const Map2d* map_2d = nullptr;       ///< null: none
  Points points_base;  ///< obstacles of the obstacle map; when complete, also of the local map

  // Added by Surroundings::complete(), the trail by Navigator:
  Points doubtful_base;                  ///< doubtful ground, see LocalMap::doubtful_points_base()
  Points unseen_ahead_base;              ///< see LocalMap::unseen_ahead_base()
  Points possible_ramps_down_base;       ///< see LocalMap::possible_ramps_down_base()
  People people;                         ///< people who walk, in base
  const SeenDirections* seen = nullptr;  ///< null: none
  const LocalMap* local_map = nullptr;   ///< null: it has no scan
  const RearView* rear_view = nullptr;   ///< behind the robot; null: none
  const Trail* trail = nullptr;          ///< of the strip that the body has driven; null: none

  [[nodiscard]] geometry::SE2 T_map_base() const { return T_map_odom * T_odom_base; }
  /// Whether a direction (in base, positive left) has been in view long enough to drive there.
  [[nodiscard]] bool has_seen(double direction_rad) const {
    return seen != nullptr &&
           (laser_is_held ? seen->is_in_view(direction_rad) : seen->is_seen(direction_rad));
  }
  /// Whether the robot drives only over floor that the local map has seen. A laser that is held
  /// sees no floor: then floor is everywhere.
  [[nodiscard]] bool needs_seen_floor() const { return local_map != nullptr && !laser_is_held; }
};

}  // namespace nodmap::navigator
