// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/geometry/angle.hpp"
#include "common/robot/robot_params.hpp"

namespace nodmap::navigator {

/// Limits of driving, and the width of the virtual corridor.
struct DriveParams {
  double side_margin_m = 0.06;
  double max_forward_mps = 1.5;
  double max_yaw_rate_rad_s = geometry::deg_to_rad(80.0);
  double max_lateral_mps2 = 0.8;
  double creep_margin_m = 0.03;
  double creep_mps = 0.25;
  double squeeze_margin_m = 0.01;
  double squeeze_mps = 0.1;
  double reaction_s = 0.1;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("side_margin_m", side_margin_m, {0.0, 0.5},
             "Margin on each side of the body. The virtual corridor is as wide as the body and "
             "both margins.");
    // With half of it, as near a goal while the pose is DEGRADED, the robot still drives.
    v.number("max_forward_mps", max_forward_mps, {0.12, 5.2},
             "Fastest forward speed, however long the free distance is.");
    v.angle("max_yaw_rate_deg_s", max_yaw_rate_rad_s, {5.0, 180.0},
            "Fastest yaw rate while driving.");
    v.number("max_lateral_mps2", max_lateral_mps2, {0.1, 5.0},
             "Largest lateral acceleration: forward speed times yaw rate.");
    v.number("creep_margin_m", creep_margin_m, {0.0, 0.5},
             "On the way to a goal, obstacles nearer to the body's side than drive.side_margin_m, "
             "but not nearer than this, are passed at drive.creep_mps.");
    v.number("creep_mps", creep_mps, {0.0, 1.0},
             "Speed past obstacles nearer than drive.side_margin_m.");
    v.number("squeeze_margin_m", squeeze_margin_m, {0.0, 0.5},
             "On the way to a goal, if no other motion is left, obstacles nearer than "
             "drive.creep_margin_m, but not nearer than this, are passed at drive.squeeze_mps.");
    v.number("squeeze_mps", squeeze_mps, {0.0, 1.0},
             "Speed past obstacles nearer than drive.creep_margin_m.");
    v.number("reaction_s", reaction_s, {0.02, 1.0},
             "Reaction time from the middle of a scan until the robot slows down.");
  }
};

/// How fast the base follows a command, at least. How hard it brakes is in robot::Braking.
struct BaseParams {
  double acceleration_mps2 = 1.5;
  double yaw_acceleration_rad_s2 = 6.0;
  double rotation_deceleration_rad_s2 = 5.0;
  double response_s = 0.07;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("acceleration_mps2", acceleration_mps2, {0.1, 20.0},
             "Change of the base's speed on command, as rollouts assume it.");
    v.number("yaw_acceleration_rad_s2", yaw_acceleration_rad_s2, {0.1, 100.0},
             "Change of the base's yaw rate on command, as rollouts assume it.");
    v.number("rotation_deceleration_rad_s2", rotation_deceleration_rad_s2, {0.1, 100.0},
             "Deceleration used to compute the angle in which a rotation on the spot stops: a "
             "third of what the KURT2 reaches.");
    v.number("response_s", response_s, {0.0, 0.5},
             "Time from a command until the base has followed it, if it changes the speed by no "
             "more than robot.braking.deceleration_mps2 does in that time.");
  }
};

struct SteerParams {
  double open_space_m = 1.0;
  double chord_m = 0.8;
  double view_half_rad = geometry::deg_to_rad(70.0);
  int sweeps_to_trust = 2;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number(
        "open_space_m", open_space_m, {0.3, 5.0},
        "Free distance that suffices to steer in a direction. It has half of the full weight in "
        "the free-space orientation.");
    v.number("chord_m", chord_m, {0.3, 5.0},
             "Length of the chord of the arc that leads to the steering direction.");
    v.angle(
        "view_half_deg", view_half_rad, {10.0, 89.0},
        "Directions up to this angle from ahead are in the laser's view, also close to the robot.");
    v.integer("sweeps_to_trust", sweeps_to_trust, {1, 10},
              "Number of sweeps during which a direction must have been in view before the robot "
              "drives in it.");
  }
};

struct TurnParams {
  double margin_m = 0.04;
  double rate_rad_s = geometry::deg_to_rad(60.0);
  double until_free_m = 0.6;
  double retry_s = 5.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("margin_m", margin_m, {0.0, 0.5},
             "Margin around the body when it rotates on the spot.");
    v.angle("rate_deg_s", rate_rad_s, {5.0, 180.0}, "Yaw rate on the spot.");
    v.number("until_free_m", until_free_m, {0.2, 5.0},
             "Turn ends when the free distance ahead is at least this.");
    v.number("retry_s", retry_s, {0.5, 60.0},
             "Pause after a full rotation without a free direction.");
  }
};

struct BackUpParams {
  double speed_mps = 0.1;
  double distance_m = 2.0;
  double unseen_m = 1.2;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("speed_mps", speed_mps, {0.02, 0.3},
             "Speed at which the robot backs up along its trail where it cannot turn.");
    v.number("distance_m", distance_m, {0.05, 4.0},
             "Longest distance that the robot backs up at once.");
    v.number("unseen_m", unseen_m, {0.0, 2.0},
             "How far from where it was set down the robot backs out of a place in which it cannot "
             "turn, over ground that it has not seen, as far as its range finders show free space. "
             "0: not at all.");
  }
};

/// The ages from which on an input is stale.
struct StalenessParams {
  double map_s = 0.1;
  double odometry_s = 0.1;
  double pitch_command_s = 0.12;
  double pitch_state_s = 0.15;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("map_s", map_s, {0.03, 0.25},
             "The robot halts when the obstacle map or the last scan is older than this.");
    v.number("odometry_s", odometry_s, {0.03, 0.25},
             "The robot halts when odometry is older than the map by more than this.");
    v.number("pitch_command_s", pitch_command_s, {0.03, 0.25},
             "The robot halts when the pitch controller's speed bound is older than this.");
    v.number("pitch_state_s", pitch_state_s, {0.03, 0.25},
             "The robot halts when the last reading of the pitch servo is older than this.");
  }
};

/// Ramps as ground.
struct GroundParams {
  double max_slope_rad = geometry::deg_to_rad(14.0);
  double wheelbase_m = 0.30;
  double track_m = 0.28;
  double tilt_tolerance_rad = geometry::deg_to_rad(1.0);
  double sloped_mps = 0.5;
  double doubt_from_m = 1.5;

  template <class Visitor>
  void describe(Visitor& v) {
    v.angle("max_slope_deg", max_slope_rad, {0.0, 25.0},
            "Steeper ground is an obstacle or a hole. The default allows ramps of 12 degrees plus "
            "the error of the measured slope.");
    v.number("wheelbase_m", wheelbase_m, {0.05, 5.0},
             "Distance from the front to the rear wheels, on which the body rests.");
    v.number("track_m", track_m, {0.05, 5.0}, "Distance from the left to the right wheels.");
    v.angle("tilt_tolerance_deg", tilt_tolerance_rad, {0.0, 5.0},
            "Error of the tilt near a ramp; replaces local_map.tilt_tolerance_deg there.");
    v.number("sloped_mps", sloped_mps, {0.06, 5.2}, "Fastest speed on and near ramps.");
    v.number(
        "doubt_from_m", doubt_from_m, {0.5, 10.0},
        "Near slopes, something that could be a ramp up is unknown, not yet an obstacle, if it "
        "is farther away than this.");
  }
};

/// The grid of the ground around the robot.
struct LocalMapParams {
  bool use = true;
  double cell_size_m = 0.025;
  double range_m = 2.5;
  double floor_tolerance_m = 0.02;
  double tilt_tolerance_rad = geometry::deg_to_rad(0.4);
  double floor_return_m = 1.6;
  double max_gap_m = 0.15;
  double wide_gap_m = 0.3;
  double forget_after_m = 20.0;
  GroundParams ground;

  template <class Visitor>
  void describe(Visitor& v) {
    v.flag("use_local_map", use,
           "Also drive by the local map; without it holes and low obstacles are not seen.");
    v.number("cell_size_m", cell_size_m, {0.015, 0.1}, "Edge of a cell.");
    v.number("range_m", range_m, {0.5, 5.0},
             "Obstacles and holes of the local map count up to this distance.");
    v.number("floor_tolerance_m", floor_tolerance_m, {0.005, 0.2},
             "A point more than this above or below the ground is not floor.");
    v.angle("tilt_tolerance_deg", tilt_tolerance_rad, {0.0, 5.0},
            "Error of pitch and tilt, by which the floor tolerance grows with distance.");
    v.number("floor_return_m", floor_return_m, {0.5, 10.0},
             "A beam that should meet the floor within this range but does not come back has seen "
             "a hole.");
    v.number("max_gap_m", max_gap_m, {0.02, 1.0},
             "Floor points of neighbouring beams and scans no farther apart than this have floor "
             "between them. The robot can always make an emergency stop before floor that was not "
             "seen this densely.");
    v.number("wide_gap_m", wide_gap_m, {0.02, 2.0},
             "The robot can always make an ordinary stop before floor that was seen with gaps "
             "wider than this.");
    v.number("forget_after_m", forget_after_m, {1.0, 1000.0},
             "An obstacle that is not measured again is forgotten after this length of path; a "
             "rotation of 1 rad counts as 4 m.");
    v.section("ground", ground);
  }
};

/// Driving to a goal by plan.
struct PlannerParams {
  bool use = true;
  bool roams = true;
  bool use_map = false;
  double replan_s = 0.5;
  double min_clearance_m = 0.06;
  double wide_m = 0.35;
  double nearness_price = 3.0;
  double unknown_price = 0.7;
  double map_price = 0.35;
  double failure_price = 3.0;
  double ample_clearance_m = 0.1;
  double ample_clearance_m_per_mps = 0.15;
  double clearance_weight = 2.5;
  double smoothness_weight = 0.03;
  double reverse_price = 0.3;
  double rotation_rad_s = geometry::deg_to_rad(60.0);

  template <class Visitor>
  void describe(Visitor& v) {
    v.flag("use_planner", use,
           "Drive to a goal by plan and rollouts; otherwise by Steer, Brake and Turn.");
    v.flag("roams", roams, "Roam by plan and rollouts; otherwise by Steer, Brake and Turn.");
    v.flag(
        "use_map", use_map,
        "Plan to a goal on the 2D map as well, where the local map has not shown the ground: for a "
        "robot with a saved map. With the map that is still being drawn it is slower.");
    v.number("replan_s", replan_s, {0.05, 10.0}, "Time from one global plan to the next.");
    v.number(
        "min_clearance_m", min_clearance_m, {0.0, 0.5},
        "No fast rollout brings the body nearer to an obstacle than this. A path that does costs "
        "4 m more per metre.");
    v.number("wide_m", wide_m, {0.05, 3.0},
             "A path costs more the nearer it is to obstacles, up to this much more than the least "
             "clearance.");
    v.number("nearness_price", nearness_price, {0.0, 7.0},
             "Additional cost of a metre of path at the least clearance, metres.");
    v.number("unknown_price", unknown_price, {0.0, 5.0},
             "Additional cost of a metre of path over ground that was not seen, metres.");
    v.number("map_price", map_price, {0.0, 5.0},
             "The same over ground that only the 2D map shows as free, metres.");
    v.number("failure_price", failure_price, {0.0, 10.0},
             "Additional cost of a metre of path where the robot could not go on, metres.");
    v.number("ample_clearance_m", ample_clearance_m, {0.01, 1.0},
             "Clearance beyond which a slow rollout costs nothing for clearance.");
    v.number("ample_clearance_m_per_mps", ample_clearance_m_per_mps, {0.0, 1.0},
             "Increase of that clearance for each m/s of a rollout's speed, metres.");
    v.number("clearance_weight", clearance_weight, {0.0, 10.0},
             "Cost of a metre that a rollout drives without clearance, metres.");
    v.number("smoothness_weight", smoothness_weight, {0.0, 2.0},
             "Cost of a change of speed by 1 m/s or of yaw rate by 1 rad/s, metres.");
    v.number("reverse_price", reverse_price, {0.0, 5.0}, "Cost of driving backwards, metres.");
    v.angle("rotation_deg_s", rotation_rad_s, {5.0, 180.0},
            "Fastest yaw rate on the spot and backwards.");
  }
};

/// The last metre to a goal with a heading.
struct DockingParams {
  double rotation_rad_s = geometry::deg_to_rad(30.0);
  double staging_m = 0.8;
  double line_m = 0.12;
  double speed_mps = 0.15;
  double settle_s = 1.5;
  int tries = 5;

  template <class Visitor>
  void describe(Visitor& v) {
    v.angle("rotation_deg_s", rotation_rad_s, {5.0, 180.0},
            "Fastest yaw rate on the spot on the way to the staging place: the faster the robot "
            "rotates, the less exactly 2D SLAM maps what docking then relies on.");
    v.number("staging_m", staging_m, {0.3, 3.0},
             "Distance of the staging place, where docking begins, straight behind the goal.");
    v.number("line_m", line_m, {0.05, 1.0},
             "Length over which the distance to the line through the goal decays.");
    v.number("speed_mps", speed_mps, {0.05, 0.5}, "Fastest speed along the line.");
    v.number("settle_s", settle_s, {0.1, 20.0},
             "The robot is stationary for this long before its pose is checked: 2D SLAM gets a "
             "level scan about once a second.");
    v.integer("tries", tries, {1, 100},
              "After this many tries and corrections the robot reports that it cannot dock.");
  }
};

/// People who walk.
struct PeopleParams {
  bool use = true;
  double margin_m = 0.08;
  double comfort_m = 0.45;
  double ahead_s = 1.2;
  double obstruction_cost_m_per_s = 4.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.flag("use_people", use,
           "Track people and give way to them; otherwise only wait for what approaches.");
    v.number("margin_m", margin_m, {0.0, 0.5},
             "Distance from a walking person at which the robot is stationary, in addition to the "
             "errors of the track.");
    v.number("comfort_m", comfort_m, {0.05, 2.0},
             "A rollout that keeps more than this distance from a walking person, and from that "
             "person's path ahead, costs nothing for it.");
    v.number("ahead_s", ahead_s, {0.0, 5.0}, "For how long ahead a walking person's path counts.");
    v.number("obstruction_cost_m_per_s", obstruction_cost_m_per_s, {0.0, 50.0},
             "Cost of each second that a rollout spends in the middle of a walking person's path, "
             "metres.");
  }
};

struct NavigatorParams {
  robot::RobotParams robot;
  DriveParams drive;
  BaseParams base;
  SteerParams steer;
  TurnParams turn;
  BackUpParams back_up;
  StalenessParams staleness;
  LocalMapParams local_map;
  PlannerParams planner;
  DockingParams docking;
  PeopleParams people;
  std::string geofence;
  double drive_valid_s = 0.15;

  template <class Visitor>
  void describe(Visitor& v) {
    robot.describe(v);
    v.section("drive", drive);
    v.section("base", base);
    v.section("steer", steer);
    v.section("turn", turn);
    v.section("back_up", back_up);
    v.section("staleness", staleness);
    v.section("local_map", local_map);
    v.section("planner", planner);
    v.section("docking", docking);
    v.section("people", people);
    v.text("geofence", geofence,
           "The area that the robot does not leave: a polygon in the frame map, metres, such as "
           "POLYGON((-1 -2, 8 -2, 8 5, -1 5)); further rings are holes. Empty: none.");
    v.number("drive_valid_s", drive_valid_s, {0.05, 0.2}, "How long the base obeys a DRIVE.");
    describe_former_names(v);
  }

 private:
  template <class Visitor>
  static void describe_former_names(Visitor& v) {
    for (const char* name : {"side_margin_m", "max_forward_mps", "max_yaw_rate_deg_s",
                             "max_lateral_mps2", "reaction_s"}) {
      v.renamed(name, std::string("drive.") + name);
    }
    for (const char* name : {"open_space_m", "chord_m", "view_half_deg"}) {
      v.renamed(name, std::string("steer.") + name);
    }
    v.renamed("half_sweeps_to_trust", "steer.sweeps_to_trust");
    v.renamed("turn_margin_m", "turn.margin_m");
    v.renamed("turn_rate_deg_s", "turn.rate_deg_s");
    v.renamed("turn_until_free_m", "turn.until_free_m");
    v.renamed("retry_s", "turn.retry_s");
    v.renamed("back_up_mps", "back_up.speed_mps");
    v.renamed("back_up_m", "back_up.distance_m");
    v.renamed("map_stale_s", "staleness.map_s");
    v.renamed("odometry_stale_s", "staleness.odometry_s");
    v.renamed("pitch_command_stale_s", "staleness.pitch_command_s");
    v.renamed("pitch_state_stale_s", "staleness.pitch_state_s");
    v.renamed("planner.least_clearance_m", "planner.min_clearance_m");
    v.renamed("planner.ample_clearance_s", "planner.ample_clearance_m_per_mps");
    v.renamed("people.weight_mps", "people.obstruction_cost_m_per_s");
  }
};

/// Checks what no single parameter shows. Throws params::ParamError.
void check(const NavigatorParams& params);

}  // namespace nodmap::navigator
