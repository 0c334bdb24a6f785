// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/formats/tum.hpp"
#include "common/geometry/se3.hpp"

namespace nodmap::trial {

/// Start of the simulation in microseconds since the Unix epoch: 2008-07-01 in UTC, when the paper
/// was presented.
inline constexpr std::int64_t kEpochUs = 1'214'870'400'000'000;

/// The true state at one moment. Times are microseconds since the start of the simulation.
struct TruthSample {
  std::int64_t time_us = 0;
  geometry::SE3 T_world_base = geometry::SE3::Identity();
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
  double clearance_m = 0.0;
  double person_clearance_m = 0.0;  ///< to the nearest actor; infinite without
  std::int64_t collisions = 0;
  std::int64_t bumps = 0;
  std::int64_t contacts_caused = 0;
  std::int64_t falls = 0;
};

/// What is recorded of a trial to compute its metrics from.
struct TrialRecord {
  std::vector<TruthSample> truth;           ///< every 10 ms from 0 on
  std::vector<std::int64_t> sweep_ends_us;  ///< when the pitch reversed
  formats::Trajectory odometry;             ///< as published
  std::optional<std::int64_t> started_us;   ///< the first SCAN; metrics count from here
  std::optional<std::int64_t> moved_us;     ///< when it had moved by 0.1 m from its start
  std::vector<std::int64_t> arrivals_us;    ///< when the navigator reported its arrival at a goal
  std::optional<std::int64_t> reached_us;   ///< within Task::arrival_radius_m of the last goal
};

}  // namespace nodmap::trial
