// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/formats/tum.hpp"
#include "common/geometry/se3.hpp"

namespace nodmap::trial {

/// How things were at one moment. Times are microseconds since the simulation's start.
struct TruthSample {
  std::int64_t time_us = 0;
  geometry::SE3 T_world_base = geometry::SE3::Identity();
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
  double clearance_m = 0.0;
  std::int64_t collisions = 0;
  std::int64_t bumps = 0;
};

/// What a trial is judged by.
struct TrialRecord {
  std::vector<TruthSample> truth;          ///< every 10 ms from 0 on
  std::vector<std::int64_t> turns_us;      ///< when the head turned at an end of its sweep
  formats::Trajectory odometry;            ///< as published
  std::optional<std::int64_t> began_us;    ///< the first SCAN: from here on the trial counts
  std::optional<std::int64_t> arrived_us;  ///< the navigator first said so
};

}  // namespace nodmap::trial
