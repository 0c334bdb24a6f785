// SPDX-License-Identifier: BSD-3-Clause
// The metrics of a trial, computed from its record.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/angle.hpp"
#include "common/geometry/time.hpp"
#include "sim/world/world.hpp"
#include "tools/trial/exploration_monitor.hpp"
#include "tools/trial/record.hpp"

namespace nodmap::trial {

/// Quantiles by nearest rank; all zero without values.
struct Quantiles {
  double p50 = 0.0;
  double p99 = 0.0;
  double max = 0.0;
  std::size_t n = 0;
};

[[nodiscard]] Quantiles quantiles(const std::vector<double>& values);

/// Metrics of the drive from the first SCAN on.
struct DriveMetrics {
  sim::ContactCounts contacts;
  std::optional<double> first_collision_s;
  /// For each collision, how long after it the navigator reported that the wheels slip; empty if it
  /// did not before the next collision.
  std::vector<std::optional<double>> noticed_s;
  std::optional<double> first_motion_s;
  double duration_s = 0.0;
  double distance_m = 0.0;  ///< path length of base's origin
  double mean_speed_mps = 0.0;
  double max_speed_mps = 0.0;
  double min_clearance_m = 0.0;
  double close_to_person_s = 0.0;  ///< nearer than kPersonalSpaceM to an actor
};

/// Intimate distance (Hall, The Hidden Dimension, 1966); a robot nearer than that disturbs people.
inline constexpr double kPersonalSpaceM = 0.45;

/// All zero if there was no scan.
[[nodiscard]] DriveMetrics drive_metrics(const TrialRecord& record);

/// How the robot drove to the goals of its world.
struct GoalMetrics {
  std::optional<time::SteadyTime> reached;  ///< when the last goal was reached
  double path_m = 0.0;           ///< path length from the first scan until then, or until the end
  std::optional<double> time_s;  ///< from the first scan until then
  std::optional<double> after_motion_s;  ///< from when the robot had moved by 0.1 m
  double start_to_goal_m = 0.0;          ///< straight-line distance
  double remaining_m = 0.0;              ///< straight-line distance at the end
  /// From the first scan until the navigator reported that no path leads to the goal, after which
  /// it did not drive on.
  std::optional<double> no_path_s;
  std::optional<double> heading_error_rad;  ///< at the end; empty if the goal has no heading
  /// Success weighted by path length (Anderson et al., On Evaluation of Embodied Navigation Agents,
  /// 2018), for the path to where the goal counts as reached. Empty if the shortest path is
  /// unknown.
  std::optional<double> spl;
};

/// How an exploration went. Paths and times count from the first scan.
struct ExplorationMetrics {
  double seen_ratio = 0.0;        ///< at the end
  std::optional<double> to_90_m;  ///< path length until 90 % of the floor had been seen
  std::optional<double> to_90_s;
  std::optional<double> home_s;  ///< until the explorer reported that it is home
  double path_m = 0.0;           ///< total path length
  double from_start_m = 0.0;     ///< at the end
};

[[nodiscard]] ExplorationMetrics exploration_metrics(const TrialRecord& record,
                                                     const ExplorationRecord& exploration);

/// How near the robot must be to the last goal.
struct GoalTolerance {
  double distance_m = 0.0;
  double heading_rad = geometry::kPi;  ///< of a goal with a heading
};

/// The robot has reached the last goal when it has reported the arrival at each goal and is within
/// the tolerance of the last one, with the error granted to its pose; for a Task with an arrival
/// radius, as soon as it is within that radius.
[[nodiscard]] GoalMetrics goal_metrics(const TrialRecord& record, const sim::World& world,
                                       const GoalTolerance& tolerance,
                                       std::optional<double> shortest_path_m);

/// A fault or kill that must stop the robot.
struct Disturbance {
  std::string what;
  time::SteadyTime started{};
  time::SteadyTime ended{};
};

/// How the robot stopped.
struct StopMetrics {
  double speed_mps = 0.0;                 ///< when the disturbance began
  std::optional<double> stopped_after_s;  ///< empty: not before the disturbance ended
  double distance_m = 0.0;                ///< until it stopped
  double braking_distance_m = 0.0;        ///< v^2 / 2a
  /// From the end of the disturbance until it drives at least half as fast as before; if it was
  /// stationary, until it moves. Empty: never.
  std::optional<double> resumed_after_s;
};

/// Below these the robot counts as stationary; allow for encoder noise and the end of a braking
/// curve.
inline constexpr double kStationaryMps = 0.02;
inline constexpr double kStationaryRadS = 0.05;

[[nodiscard]] StopMetrics stop_metrics(const TrialRecord& record, const Disturbance& disturbance,
                                       double deceleration_mps2);

/// The true trajectory, stamped as messages are; `planar`: seen from above.
[[nodiscard]] formats::Trajectory true_trajectory(const TrialRecord& record, bool planar);

}  // namespace nodmap::trial
