// SPDX-License-Identifier: BSD-3-Clause
// The metrics of a trial, computed from its record.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/trial/record.hpp"

namespace nodmap::trial {

/// By nearest rank; all zero without values.
struct Quantiles {
  double p50 = 0.0;
  double p99 = 0.0;
  double max = 0.0;
  std::size_t n = 0;
};

[[nodiscard]] Quantiles quantiles(std::vector<double> values);

/// From the first SCAN on.
struct DriveMetrics {
  std::int64_t collisions = 0;
  std::int64_t bumped = 0;
  std::int64_t contacts_caused = 0;
  std::int64_t falls = 0;
  std::optional<double> first_collision_s;
  std::optional<double> first_motion_s;
  double duration_s = 0.0;
  double distance_m = 0.0;  ///< of base's origin, without rotations on the spot
  double mean_speed_mps = 0.0;
  double max_speed_mps = 0.0;
  double min_clearance_m = 0.0;
};

/// All zero when there was no scan.
[[nodiscard]] DriveMetrics drive_metrics(const TrialRecord& record);

/// Durations of the sweeps in seconds, without the movement from the servo's rest position.
[[nodiscard]] std::vector<double> sweep_times_s(const TrialRecord& record);

/// A fault or kill that must stop the robot.
struct Disturbance {
  std::string what;
  std::int64_t started_us = 0;
  std::int64_t ended_us = 0;
};

/// How the robot stopped.
struct StopMetrics {
  double speed_mps = 0.0;                 ///< when the disturbance began
  std::optional<double> stopped_after_s;  ///< empty: not before the disturbance ended
  double distance_m = 0.0;                ///< until it stopped
  double braking_distance_m = 0.0;        ///< v^2 / 2a
  std::optional<double> resumed_after_s;  ///< after the end of the disturbance; empty: never
};

/// Below, the robot is stationary: encoder noise, and the end of a braking curve.
inline constexpr double kStationaryMps = 0.02;

[[nodiscard]] StopMetrics stop_metrics(const TrialRecord& record, const Disturbance& disturbance,
                                       double deceleration_mps2);

/// The true trajectory, stamped as messages are; `planar`: seen from above.
[[nodiscard]] formats::Trajectory true_trajectory(const TrialRecord& record, bool planar);

}  // namespace nodmap::trial
