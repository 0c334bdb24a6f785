// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "common/geometry/angle.hpp"
#include "drivers/kurt/node.hpp"
#include "drivers/laser3d/node.hpp"
#include "modules/explorer/node.hpp"
#include "modules/map_server/node.hpp"
#include "modules/navigator/node.hpp"
#include "modules/pitch_controller/node.hpp"
#include "modules/slam2d/node.hpp"
#include "modules/slam6d/node.hpp"
#include "sim/devices/simulated_robot.hpp"

namespace nodmap::trial {

/// Parameters of the loop itself, not of any of its parts.
struct LoopParams {
  /// Longer than measured on two cores (bench/REPORT.md), because the loop must not be faster than
  /// the robot.
  double message_delay_s = 0.002;
  double message_jitter_s = 0.001;
  double goal_tolerance_m = 0.3;
  double docking_tolerance_m = 0.02;
  double docking_tolerance_rad = geometry::deg_to_rad(1.0);

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("message_delay_s", message_delay_s, {0.0, 0.5},
             "Shortest time from the publishing of a message to its handling.");
    v.number("message_jitter_s", message_jitter_s, {0.0, 0.1},
             "Mean of the exponentially distributed delay that is added for each reader.");
    v.number("goal_tolerance_m", goal_tolerance_m, {0.05, 5.0}, "Tolerance of the world's goals.");
    v.number("docking_tolerance_m", docking_tolerance_m, {0.005, 1.0},
             "Tolerance of a goal with a heading.");
    v.angle("docking_tolerance_deg", docking_tolerance_rad, {0.1, 45.0},
            "Tolerance of the heading there.");
  }
};

/// What the trial changes in its world.
struct WorldParams {
  double floor_reflectivity = 0.0;
  double people_reflectivity = 0.0;
  bool legs = false;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("floor_reflectivity", floor_reflectivity, {0.0, 1.0},
             "Reflectivity of the floor, such as 0.1 for a dark carpet; 0: as in the world.");
    v.number("people_reflectivity", people_reflectivity, {0.0, 1.0},
             "Reflectivity of the people's clothes; 0: as in the world.");
    v.flag("legs", legs, "Give all people legs, instead of a cylinder down to the floor.");
  }
};

/// The parameters of all parts of a trial.
struct AllParams {
  LoopParams loop;
  WorldParams world;
  sim::SimulatedRobotParams sim;
  kurt::KurtNode::Params kurt;
  laser3d::Laser3dNode::Params laser3d;
  pitch_controller::PitchControllerNode::Params pitch_controller;
  map_server::MapServerNode::Params map_server;
  navigator::NavigatorNode::Params navigator;
  explorer::ExplorerNode::Params explorer;
  slam2d::Slam2dNode::Params slam2d;
  slam6d::Slam6dNode::Params slam6d;

  /// Sets "process.key=value", as given to --set. Throws params::ParamError.
  void set_assignment(std::string_view assignment);

  /// All parameters as YAML, part by part.
  [[nodiscard]] std::string to_yaml();
};

}  // namespace nodmap::trial
