// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "nodmap/base_sensors_t.hpp"
#include "nodmap/drive_t.hpp"
#include "nodmap/egomap_t.hpp"
#include "nodmap/exploration_t.hpp"
#include "nodmap/goal_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/path_t.hpp"
#include "nodmap/pitch_command_t.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "nodmap/pose_t.hpp"
#include "nodmap/scan_t.hpp"
#include "nodmap/status_t.hpp"
#include "nodmap/stop_t.hpp"
#include "nodmap/tracks_t.hpp"
#include "nodmap/truth_t.hpp"
#include "procman_lcm/deputy_info_t.hpp"

namespace nodmap::foxglove::test {

/// A robot that nods and drives along a corridor with walls 2 m to each side. Each function returns
/// a channel's message at a time (s) since kBeginUs, with values computed from it.
inline constexpr std::int64_t kBeginUs = 1'700'000'000'000'000;
inline constexpr double kSpeedMps = 0.5;
inline constexpr double kHalfWidthM = 2.0;

/// Microseconds since the epoch.
[[nodiscard]] std::int64_t utime(double time_s);

[[nodiscard]] nodmap::scan_t scan_at(double time_s);
[[nodiscard]] nodmap::odometry_t odometry_at(double time_s);
[[nodiscard]] nodmap::pitch_state_t pitch_state_at(double time_s);
[[nodiscard]] nodmap::pitch_command_t pitch_command_at(double time_s);
[[nodiscard]] nodmap::drive_t drive_at(double time_s);
[[nodiscard]] nodmap::navigation_t navigation_at(double time_s);
[[nodiscard]] nodmap::egomap_t egomap_at(double time_s);
[[nodiscard]] nodmap::pose_t pose_at(double time_s);
[[nodiscard]] nodmap::truth_t truth_at(double time_s);
[[nodiscard]] nodmap::goal_t goal();
[[nodiscard]] nodmap::path_t path();
/// A person who walks in view, and one who is out of sight.
[[nodiscard]] nodmap::tracks_t tracks();
[[nodiscard]] nodmap::exploration_t exploration();
[[nodiscard]] nodmap::stop_t stop();
[[nodiscard]] nodmap::base_sensors_t base_sensors_at(double time_s);
[[nodiscard]] nodmap::status_t status_at(double time_s);
[[nodiscard]] procman_lcm::deputy_info_t deputy_info_at(double time_s);

}  // namespace nodmap::foxglove::test
