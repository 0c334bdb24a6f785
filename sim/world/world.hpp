// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/geometry/se2.hpp"

namespace nodmap::sim {

/// Fraction of the laser's light that is reflected, relative to a white wall; this is a painted
/// wall.
inline constexpr double kDefaultReflectivity = 0.8;

/// An upright box, rotated about the vertical axis. Metres, radians, world frame.
struct Box {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d size = Eigen::Vector3d::Ones();
  double yaw_rad = 0.0;
};

/// An upright cylinder; `center` is the middle of its axis.
struct Cylinder {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius_m = 0.1;
  double height_m = 1.0;
};

/// A surface that rises evenly from the middle of one edge to the middle of the other, with nothing
/// below it.
struct Ramp {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d to = Eigen::Vector3d::UnitX();
  double width_m = 1.0;
};

/// Triangles; already in the world frame.
struct Mesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
};

/// A static object. A wall in a file becomes a Box.
struct Object {
  std::variant<Box, Cylinder, Ramp, Mesh> shape;
  double reflectivity = kDefaultReflectivity;
};

/// A rectangular hole in the floor.
struct Pit {
  Eigen::Vector2d min = Eigen::Vector2d::Zero();
  Eigen::Vector2d max = Eigen::Vector2d::Zero();
  double depth_m = 0.5;
};

struct Waypoint {
  double time_s = 0.0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
};

/// A person, or another upright cylinder on the floor, that moves at constant speed from waypoint
/// to waypoint. Before the first time it is at the first waypoint; after the last it starts again
/// (loop) or stays. An actor that reacts walks to the same places at the same speed, but makes way
/// for the robot, other actors and walls (sim/body/crowd.hpp).
struct Actor {
  double radius_m = 0.25;
  double height_m = 1.75;
  std::vector<Waypoint> path;
  bool loop = false;
  bool reacts = false;
  bool has_legs = false;                       ///< up to the hip two legs, instead of the cylinder
  double reflectivity = kDefaultReflectivity;  ///< of the clothes
  double appear_s = 0.0;
  double vanish_s = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool is_present(double time_s) const;
  [[nodiscard]] Eigen::Vector2d position(double time_s) const;
  /// The time within the first round that corresponds to `time_s`.
  [[nodiscard]] double time_in_round(double time_s) const;
};

/// Where the axes of two legs are: upright cylinders from the floor to the hip.
struct Legs {
  static constexpr double kRadiusM = 0.07;
  static constexpr double kHipM = 0.8;

  Eigen::Vector2d left = Eigen::Vector2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
};

/// An actor at one moment.
struct ActorState {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double radius_m = 0.0;
  double height_m = 0.0;
  std::size_t actor = 0;  ///< its index in World::actors
  double reflectivity = kDefaultReflectivity;
  std::optional<Legs> legs = std::nullopt;
};

/// When a drive to the goals has succeeded or failed, if this is not decided by the robot's own
/// report alone.
struct Task {
  /// The last goal counts as reached when base's origin is this near, whatever the robot reports.
  std::optional<double> arrival_radius_m;
  /// Time limit, counted from when the robot has moved 0.1 m.
  std::optional<double> time_limit_s;
  /// Length of the shortest path from the start over all goals, if a search on flat ground cannot
  /// find it.
  std::optional<double> shortest_path_m;
  /// Length of the path from which a benchmark computes its reference time.
  std::optional<double> reference_path_m;
  /// The first contact ends the drive.
  bool ends_at_contact = false;
};

/// The content of a WORLD.yaml. The floor is z = 0 except in pits.
struct World {
  std::string name;
  std::vector<Object> objects;
  std::vector<Pit> pits;
  double floor_reflectivity = kDefaultReflectivity;  ///< also that of the pits
  std::vector<Actor> actors;
  geometry::SE2 T_world_start;
  double start_height_m = 0.0;         ///< height of the ramp or platform on which the robot starts
  std::vector<Eigen::Vector2d> goals;  ///< to be reached in this order; may be empty
  std::optional<double> goal_heading_rad;  ///< heading of base at the last goal; empty: any
  Task task;
};

}  // namespace nodmap::sim
