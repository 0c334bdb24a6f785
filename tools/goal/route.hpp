// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/time.hpp"

namespace nodmap {

/// Waypoints that the robot drives to one after the other, following the reports of the navigator.
/// A waypoint without a path counts as missed, and the robot drives to the next one.
class Route {
 public:
  enum class Event : std::uint8_t { kNone, kReached, kMissed };

  /// `waypoints_map`: at least one, metres in map. With `is_patrol` the first follows after the
  /// last. A waypoint is missed only after `patience` without a path, because the navigator looks
  /// around before it gives up a path, and a door may open.
  Route(std::vector<Eigen::Vector2d> waypoints_map, bool is_patrol, time::Duration patience);

  /// Takes the navigator's report whether the robot is at the waypoint.
  Event take_arrival(bool has_arrived);

  /// Takes the navigator's report, ten times a second, whether it knows a path to the waypoint.
  /// Silence is no time without a path: while the robot is halted, the navigator looks for none.
  /// But it goes on reporting that there is none to a waypoint outside the geofence.
  Event take_path(bool has_path, time::SteadyTime now);

  /// Whether no waypoint is left; on patrol, whether all were missed in turn.
  [[nodiscard]] bool is_over() const { return is_over_; }
  /// The present or last waypoint, counted from 0.
  [[nodiscard]] std::size_t index() const { return index_; }
  [[nodiscard]] const Eigen::Vector2d& waypoint_map() const { return waypoints_map_[index_]; }
  [[nodiscard]] std::size_t size() const { return waypoints_map_.size(); }
  [[nodiscard]] int num_missed() const { return num_missed_; }

 private:
  void go_on();
  void forget_no_path();

  std::vector<Eigen::Vector2d> waypoints_map_;
  bool is_patrol_ = false;
  time::Duration patience_;
  std::size_t index_ = 0;
  std::optional<time::SteadyTime> no_path_at_;  // when the navigator last said so
  time::Duration without_path_{};
  std::size_t missed_in_turn_ = 0;
  int num_missed_ = 0;
  bool is_over_ = false;
};

}  // namespace nodmap
