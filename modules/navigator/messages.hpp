// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/goal.hpp"
#include "modules/navigator/local_map/local_map.hpp"
#include "modules/navigator/people/person.hpp"
#include "modules/navigator/people/proximity.hpp"
#include "nodmap/base_sensors_t.hpp"
#include "nodmap/goal_t.hpp"
#include "nodmap/local_map_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/path_t.hpp"
#include "nodmap/pitch_command_t.hpp"
#include "nodmap/pose_t.hpp"
#include "nodmap/tracks_t.hpp"

namespace nodmap::navigator {

// Converts messages to the navigator's values and back.

/// Whether a GOAL message is plausible: a goal, or the end of one.
[[nodiscard]] bool is_plausible(const nodmap::goal_t& message);

/// Whether a PITCH_COMMAND message is plausible. The laser driver does not carry out a sweep whose
/// ends are exchanged, so the navigator must not take it for that of a held laser, which needs no
/// floor ahead.
[[nodiscard]] bool is_plausible(const nodmap::pitch_command_t& message);

/// Reads a plausible GOAL; empty if it ends the goal.
[[nodiscard]] std::optional<GoalInMap> read_goal(const nodmap::goal_t& message);

/// The standard deviation of the position in its worst direction, metres; +infinity if the
/// covariance is not known.
[[nodiscard]] double position_sigma_m(const nodmap::pose_t& message);

/// The number of a behaviour in navigation_t.
[[nodiscard]] std::int8_t code_of(Behaviour behaviour);

/// PATH: the planned path to the goal, and the arc that the robot drives. `path_map` has no points
/// if there is no path.
[[nodiscard]] nodmap::path_t path_message(const std::vector<Eigen::Vector2d>& path_map,
                                          const geometry::SE2& T_odom_map,
                                          const geometry::SE2& T_odom_base,
                                          const Decision& decision);

/// TRACKS: the people who walk, and those who have just come into view, in odom.
[[nodiscard]] nodmap::tracks_t tracks_message(const People& people, const People& newcomers);

/// LOCAL_MAP: the square that reaches `half_size_m` to each side of a place. One cell of the
/// message stands for 2 x 2 cells of the local map; outside the local map nothing was seen.
[[nodiscard]] nodmap::local_map_t local_map_message(const LocalMap& local_map,
                                                    const Eigen::Vector2d& p_odom,
                                                    double half_size_m);

/// The ranges of the infrared range finders.
[[nodiscard]] Proximity::Ranges ranges_of(const nodmap::base_sensors_t& message);

}  // namespace nodmap::navigator
