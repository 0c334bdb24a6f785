// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "common/geometry/time.hpp"
#include "nodmap/cloud_chunk_t.hpp"
#include "nodmap/egomap_t.hpp"
#include "nodmap/exploration_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "nodmap/scan_t.hpp"
#include "nodmap/status_t.hpp"
#include "nodmap/truth_t.hpp"

namespace nodmap::watch {

/// Counts events, in total and in the last second.
class Rate {
 public:
  void add(time::SteadyTime now);
  [[nodiscard]] double per_second(time::SteadyTime now) const;
  [[nodiscard]] std::int64_t total() const { return total_; }

 private:
  std::deque<time::SteadyTime> received_;
  std::int64_t total_ = 0;
};

/// The last STATUS of a process.
struct ProcessView {
  std::int8_t health = 0;
  std::string reason;
  std::int64_t total_handled = 0;
  std::int64_t lost = 0;
  std::int64_t corrupt = 0;
  std::int64_t rejected = 0;
  double p99_us = 0.0;
  time::SteadyTime received{};
};

/// Summarises the robot's state from its messages. Times are those of their reception.
class Overview {
 public:
  void add(const nodmap::scan_t& message, time::SteadyTime now);
  void add(const nodmap::odometry_t& message, time::SteadyTime now);
  void add(const nodmap::pitch_state_t& message, time::SteadyTime now);
  void add(const nodmap::egomap_t& obstacle_map, time::SteadyTime now);
  void add(const nodmap::navigation_t& message, time::SteadyTime now);
  void add(const nodmap::cloud_chunk_t& message, time::SteadyTime now);
  void add(const nodmap::exploration_t& message, time::SteadyTime now);
  void add(const nodmap::status_t& message, time::SteadyTime now);
  void add(const nodmap::truth_t& message, time::SteadyTime now);

  [[nodiscard]] double forward_mps() const { return forward_mps_; }
  /// Positive to the left.
  [[nodiscard]] double yaw_rate_rad_s() const { return yaw_rate_rad_s_; }
  [[nodiscard]] double pitch_rad() const { return pitch_rad_; }
  /// Distance driven, by odometry, metres.
  [[nodiscard]] double distance_m() const { return distance_m_; }
  [[nodiscard]] double max_forward_mps() const { return max_forward_mps_; }
  /// Distance from base's origin to the nearest point of the obstacle map; +infinity without any.
  [[nodiscard]] double nearest_m() const { return nearest_m_; }
  /// Of the navigator; empty if it has not said anything yet.
  [[nodiscard]] std::optional<std::int8_t> behaviour() const { return behaviour_; }
  [[nodiscard]] const std::string& reason() const { return reason_; }
  [[nodiscard]] std::int64_t keyframes() const { return keyframes_; }
  /// Whether everything has been seen and the robot is back at the start of the exploration.
  [[nodiscard]] bool is_home() const { return is_home_; }
  /// Why the explorer has ended the exploration before that; empty if it has not.
  [[nodiscard]] const std::optional<std::string>& given_up() const { return given_up_; }
  /// Free ground in the 2D map, m2, as reported by the explorer.
  [[nodiscard]] double seen_m2() const { return seen_m2_; }
  [[nodiscard]] const Rate& scans() const { return scans_; }
  [[nodiscard]] const Rate& odometry() const { return odometry_; }
  [[nodiscard]] const std::map<std::string, ProcessView>& processes() const { return processes_; }
  /// Number of lost messages, as reported by the processes.
  [[nodiscard]] std::int64_t lost() const;
  /// Number of collisions in simulation; -1 if unknown.
  [[nodiscard]] std::int64_t collisions() const { return collisions_; }
  [[nodiscard]] std::int64_t bumps() const { return bumps_; }

 private:
  Rate scans_;
  Rate odometry_;
  double forward_mps_ = 0.0;
  double yaw_rate_rad_s_ = 0.0;
  double max_forward_mps_ = 0.0;
  double pitch_rad_ = 0.0;
  double distance_m_ = 0.0;
  double nearest_m_ = std::numeric_limits<double>::infinity();
  bool has_position_ = false;
  double last_x_m_ = 0.0;
  double last_y_m_ = 0.0;
  std::optional<std::int8_t> behaviour_;
  std::string reason_;
  std::int64_t keyframes_ = 0;
  bool is_home_ = false;
  bool was_exploring_ = false;
  std::optional<std::string> given_up_;
  double seen_m2_ = 0.0;
  std::int64_t collisions_ = -1;
  std::int64_t bumps_ = 0;
  std::map<std::string, ProcessView> processes_;
};

/// Formats one line for people, at most 132 characters.
[[nodiscard]] std::string status_line(const Overview& overview, time::SteadyTime now);

}  // namespace nodmap::watch
