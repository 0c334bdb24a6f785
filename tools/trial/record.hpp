// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "common/formats/tum.hpp"
#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "sim/body/contact_counts.hpp"

namespace nodmap::trial {

/// Start of the simulation: 2008-07-01 in UTC, when the paper was presented.
inline constexpr time::Moment kStart{time::Timestamp(1'214'870'400s), {}};

/// The stamp of a message at a time of the simulation.
[[nodiscard]] inline time::Timestamp stamp_at(time::SteadyTime now) {
  return kStart.wall_at(now);
}

/// The true state at one moment. Times start at 0 with the simulation.
struct TruthSample {
  time::SteadyTime instant{};
  geometry::SE3 T_world_base = geometry::SE3::Identity();
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
  double clearance_m = 0.0;
  double person_clearance_m = 0.0;  ///< distance to the nearest actor; infinite without actors
  sim::ContactCounts contacts;
};

/// The data of a trial from which its metrics are computed.
struct TrialRecord {
  std::vector<TruthSample> truth;  ///< every 10 ms from 0 on
  /// From one reversal of the pitch to the next: without the movement from the servo's rest
  /// position.
  std::vector<double> sweep_times_s;
  formats::Trajectory odometry;               ///< as published
  std::map<std::int64_t, double> drives_mps;  ///< forward speed of each DRIVE, by drive_seq
  std::optional<time::SteadyTime> started;    ///< the first SCAN; metrics count from here
  std::optional<time::SteadyTime> moved;      ///< when the robot had moved by 0.1 m from its start
  std::vector<time::SteadyTime> arrivals;     ///< when the navigator reported its arrival at a goal
  std::optional<time::SteadyTime> reached;    ///< within Task::arrival_radius_m of the last goal
  /// When the navigator reported that no path leads to its goal; empty if it has driven on since.
  std::optional<time::SteadyTime> refused;
  /// Each time that the navigator began to report that the wheels slip.
  std::vector<time::SteadyTime> slips;
};

}  // namespace nodmap::trial
