// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/time.hpp"

namespace nodmap {

/// Waypoints that the robot drives to one after the other, by what the navigator says of the one it
/// drives to. A waypoint without a path is missed, and the next one is driven to.
class Route {
 public:
  enum class Event : std::uint8_t { kNone, kReached, kMissed };

  /// `waypoints_map`: at least one, metres in map. With `is_patrol` the first follows after the
  /// last. A waypoint is missed once there was no path for `patience`: the navigator looks around
  /// before it gives a path up, and a door may open.
  Route(std::vector<Eigen::Vector2d> waypoints_map, bool is_patrol, time::Duration patience,
        time::SteadyTime now);

  /// Whether the navigator is at its goal. What it says within the first half second is of the
  /// waypoint before.
  Event hear_arrival(bool has_arrived, time::SteadyTime now);

  /// Whether the navigator knows a path to its goal.
  Event hear_path(bool has_path, time::SteadyTime now);

  /// No waypoint is left; or, on patrol, each was missed in turn.
  [[nodiscard]] bool is_over() const { return is_over_; }
  /// The one that is driven to, or was last; counted from 0.
  [[nodiscard]] std::size_t index() const { return index_; }
  [[nodiscard]] const Eigen::Vector2d& waypoint_map() const { return waypoints_map_[index_]; }
  [[nodiscard]] std::size_t size() const { return waypoints_map_.size(); }
  [[nodiscard]] int num_missed() const { return num_missed_; }

 private:
  [[nodiscard]] bool is_settled(time::SteadyTime now) const;
  void go_on(time::SteadyTime now);

  std::vector<Eigen::Vector2d> waypoints_map_;
  bool is_patrol_ = false;
  time::Duration patience_;
  std::size_t index_ = 0;
  time::SteadyTime target_since_;
  std::optional<time::SteadyTime> no_path_since_;
  std::size_t missed_in_turn_ = 0;
  int num_missed_ = 0;
  bool is_over_ = false;
};

}  // namespace nodmap
