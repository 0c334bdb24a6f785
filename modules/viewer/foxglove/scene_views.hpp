// SPDX-License-Identifier: BSD-3-Clause
// Drawings as Foxglove's SceneUpdate.
#pragma once

#include <Eigen/Core>
#include <map>

#include "common/geometry/time.hpp"
#include "common/robot/robot_params.hpp"
#include "modules/viewer/foxglove/foxglove.hpp"
#include "nodmap/exploration_t.hpp"
#include "nodmap/goal_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/path_t.hpp"
#include "nodmap/pitch_command_t.hpp"
#include "nodmap/pose_graph_6d_t.hpp"
#include "nodmap/pose_graph_t.hpp"
#include "nodmap/tracks_t.hpp"
#include "nodmap/truth_t.hpp"

namespace nodmap::foxglove {

/// Draws the body, in base.
[[nodiscard]] Json body_scene(time::Timestamp stamp, const robot::Body& body);

/// Draws the virtual corridor ahead of the robot, coloured by the behaviour, with the behaviour's
/// name; in base.
[[nodiscard]] Json corridor_scene(const nodmap::navigation_t& navigation, const robot::Body& body);

/// The area of interest (paper, Fig. 2): the wedge between the ends of the sweep, from the pitch
/// axis at `p_base_mount` to the ground below, or 3 m; in base.
[[nodiscard]] Json area_of_interest_scene(const nodmap::pitch_command_t& command,
                                          const Eigen::Vector3d& p_base_mount,
                                          const robot::Body& body);

/// Draws the goal, in map; deletes the drawing if there is none.
[[nodiscard]] Json goal_scene(const nodmap::goal_t& goal);

/// Draws the path to the goal and the present arc; nothing without a goal.
[[nodiscard]] Json path_scene(const nodmap::path_t& path);

/// Draws each person whom the navigator tracks, in odom: a ring on the ground and the path of the
/// next second, paler if out of sight or new. Deletes the drawing if there is nobody.
[[nodiscard]] Json tracks_scene(const nodmap::tracks_t& tracks);

/// Draws the frontiers, the viewpoints with their gains, and the tour, in map; nothing if there is
/// no exploration.
[[nodiscard]] Json exploration_scene(const nodmap::exploration_t& exploration);

/// Draws the pose graph of 2D SLAM, in map: the submaps connected in order, and the loop closures
/// coloured by their state.
[[nodiscard]] Json pose_graph_scene(const nodmap::pose_graph_t& graph);

/// The same for 6D SLAM, in map_6d, with keyframes instead of submaps.
[[nodiscard]] Json pose_graph_6d_scene(const nodmap::pose_graph_6d_t& graph);

/// The poses of the graph's keyframes in map_6d, by stamp, without those that are not valid.
[[nodiscard]] std::map<time::Timestamp, geometry::SE3> keyframe_poses(
    const nodmap::pose_graph_6d_t& graph);

/// Draws the simulated people, in world.
[[nodiscard]] Json people_scene(const nodmap::truth_t& truth);

}  // namespace nodmap::foxglove
