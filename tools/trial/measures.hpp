// SPDX-License-Identifier: BSD-3-Clause
// What a trial is judged by, from what was recorded. Values in, values out.
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
struct DriveMeasures {
  std::int64_t collisions = 0;
  std::int64_t bumped = 0;
  std::optional<double> first_collision_s;
  double duration_s = 0.0;
  double distance_m = 0.0;  ///< way of base's origin, standing turns not counted
  double mean_speed_mps = 0.0;
  double max_speed_mps = 0.0;
  double min_clearance_m = 0.0;
};

/// All zero where no scan came.
[[nodiscard]] DriveMeasures measure_drive(const TrialRecord& record);

/// Times from turn to turn, seconds; the first turn is the servo's way from its place of rest.
[[nodiscard]] std::vector<double> sweep_times_s(const TrialRecord& record);

/// Something that must stop the robot.
struct Disturbance {
  std::string what;
  std::int64_t began_us = 0;
  std::int64_t ended_us = 0;
};

/// How it came to stand.
struct Stop {
  double speed_mps = 0.0;                 ///< when the disturbance began
  std::optional<double> stood_after_s;    ///< empty: it did not stand before the disturbance ended
  double way_m = 0.0;                     ///< until it stood
  double braking_way_m = 0.0;             ///< v^2 / 2a
  std::optional<double> resumed_after_s;  ///< after the end of the disturbance; empty: never
};

/// Below, the robot counts as standing: encoder noise, and the last of a brake's curve.
inline constexpr double kStandingMps = 0.02;

[[nodiscard]] Stop measure_stop(const TrialRecord& record, const Disturbance& disturbance,
                                double deceleration_mps2);

/// The true trajectory, stamped as messages are; `planar`: seen from above.
[[nodiscard]] formats::Trajectory true_trajectory(const TrialRecord& record, bool planar);

}  // namespace nodmap::trial
