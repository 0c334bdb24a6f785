// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "common/geometry/angle.hpp"
#include "common/robot/footprint.hpp"
#include "common/robot/stopping.hpp"

namespace nodmap::robot {

/// The body with its scanner, metres: a box on the floor around the origin of base.
struct Body {
  double length_m = 0.45;
  double width_m = 0.33;
  double height_m = 0.47;

  [[nodiscard]] Footprint footprint() const { return {0.5 * length_m, 0.5 * width_m}; }

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("length_m", length_m, {0.05, 5.0}, "Length of the robot's body.");
    v.number("width_m", width_m, {0.05, 5.0}, "Width of the robot's body.");
    v.number("height_m", height_m, {0.25, 5.0},
             "Height of the robot with its scanner above the floor.");
  }
};

/// Where the pitch axis of the head is mounted, metres in base.
struct Mount {
  double x_m = 0.15;
  double y_m = 0.0;
  double z_m = 0.38;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("x_m", x_m, {-2.0, 2.0}, "Position of the pitch axis in base, forward.");
    v.number("y_m", y_m, {-2.0, 2.0}, "Position of the pitch axis in base, to the left.");
    v.number("z_m", z_m, {0.1, 3.0}, "Height of the pitch axis above the floor.");
  }
};

/// Pitches of the laser plane, radians; positive looks up.
struct PitchInterval {
  double min_rad = 0.0;
  double max_rad = 0.0;

  [[nodiscard]] double range_rad() const { return max_rad - min_rad; }
};

/// A head that is to sweep over less than this is held in the middle: it does not nod.
inline constexpr double kHeldRad = geometry::deg_to_rad(0.5);

/// The limits of the nodding head: constant rate within a sweep, constant acceleration at its ends.
struct HeadLimits {
  double pitch_min_rad = geometry::deg_to_rad(-60.0);
  double pitch_max_rad = geometry::deg_to_rad(60.0);
  double pitch_rate_rad_s = 3.0;
  double pitch_acceleration_rad_s2 = 40.0;

  [[nodiscard]] PitchInterval pitch() const { return {pitch_min_rad, pitch_max_rad}; }

  /// Duration of a sweep, with half a reversal at each end.
  [[nodiscard]] double sweep_s(double range_rad, double rate_rad_s) const {
    return range_rad / rate_rad_s + rate_rad_s / pitch_acceleration_rad_s2;
  }

  /// The pitch rate that gives the shortest sweep: above sqrt(range * acceleration) the reversals
  /// cost more time than the higher rate saves.
  [[nodiscard]] double best_rate_rad_s(double range_rad) const {
    return std::min(pitch_rate_rad_s, std::sqrt(range_rad * pitch_acceleration_rad_s2));
  }

  /// The inverse of sweep_s(): the rate of a sweep of this duration, at most the head's fastest. If
  /// no sweep is so short, the rate of the shortest.
  [[nodiscard]] double rate_rad_s(double range_rad, double sweep_s) const {
    const double a = pitch_acceleration_rad_s2;
    const double root = sweep_s * sweep_s - 4.0 * range_rad / a;
    return root < 0.0 ? best_rate_rad_s(range_rad)
                      : std::min(0.5 * a * (sweep_s - std::sqrt(root)), pitch_rate_rad_s);
  }

  template <class Visitor>
  void describe(Visitor& v) {
    v.angle("pitch_min_deg", pitch_min_rad, {-85.0, -5.0}, "Lowest pitch the mechanics allow.");
    v.angle("pitch_max_deg", pitch_max_rad, {5.0, 85.0}, "Highest pitch the mechanics allow.");
    v.number("pitch_rate_rad_s", pitch_rate_rad_s, {0.05, 10.0}, "Fastest pitch rate of the head.");
    v.number("pitch_acceleration_rad_s2", pitch_acceleration_rad_s2, {0.4, 1000.0},
             "Pitch acceleration of the head at the ends of a sweep.");
  }
};

/// The heights between which the virtual corridor lies (paper, II): from floor_tolerance_m above
/// the floor to top_margin_m above the body. The permitted ranges keep the bottom below the top.
struct CorridorHeights {
  double floor_tolerance_m = 0.05;
  double top_margin_m = 0.03;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("floor_tolerance_m", floor_tolerance_m, {0.0, 0.2},
             "Height of the virtual corridor's bottom above the floor: anything lower is floor, or "
             "can be driven over.");
    v.number("top_margin_m", top_margin_m, {0.0, 1.0},
             "Height of the virtual corridor's top above the robot's body: the robot can drive "
             "under anything higher.");
  }
};

/// How the robot stops. The stopping distance (stopping.hpp) is how far it moves until it is
/// stationary; the required distance is the free distance ahead that it needs: the stopping
/// distance and `stop_margin_m`.
struct Braking {
  double deceleration_mps2 = 1.5;
  double emergency_deceleration_mps2 = 3.0;
  double wheel_arm_m = 0.2;
  double stop_margin_m = 0.15;

  /// The emergency deceleration of the robot's centre on an arc, 1/m. The base keeps the arc, and
  /// its outer wheel, faster than the centre by 1 + wheel_arm_m * |curvature|, decelerates no
  /// harder than on a straight line. An ordinary stop, with half of it, reaches its own
  /// deceleration on every arc wider than the wheel arm; tighter ones are driven so slowly that its
  /// distance is at most 4 mm too short.
  [[nodiscard]] double emergency_mps2(double curvature) const {
    return emergency_deceleration_mps2 / (1.0 + wheel_arm_m * std::abs(curvature));
  }

  /// The free distance ahead that a robot at this speed needs.
  [[nodiscard]] double required_distance_m(double forward_mps, double reaction_s) const {
    return stopping_distance(forward_mps, reaction_s, deceleration_mps2) + stop_margin_m;
  }

  /// The inverse: the greatest speed for which this free distance suffices; 0 where it is no more
  /// than the margin.
  [[nodiscard]] double permitted_mps(double free_distance_m, double reaction_s) const {
    return stoppable_speed(free_distance_m - stop_margin_m, reaction_s, deceleration_mps2);
  }

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("deceleration_mps2", deceleration_mps2, {0.1, 10.0},
             "Deceleration used to compute stopping distances. Half of what the base reaches on "
             "command, as a reserve for slopes, load and smooth floors.");
    v.number("emergency_deceleration_mps2", emergency_deceleration_mps2, {0.1, 10.0},
             "Deceleration that the base reaches on command, used where deceleration_mps2 is not "
             "sufficient.");
    v.number(
        "wheel_arm_m", wheel_arm_m, {0.0, 5.0},
        "Difference between the speeds of the outer wheel and of the robot's centre, per rad/s "
        "of yaw rate: half of the distance between the wheels, divided by nodmap-kurt's "
        "wheels.turning_adaptation.");
    v.number("stop_margin_m", stop_margin_m, {0.02, 2.0},
             "Distance left between the robot and the obstacle when it has stopped.");
  }
};

/// Describes the robot; the defaults are KURT3D (paper, II). Every process that needs any of these
/// parameters has all of them, so that all processes can read the same file
/// (config/kurt3d/robot.yaml).
struct RobotParams {
  Body body;
  Mount mount;
  HeadLimits head;
  CorridorHeights corridor;
  Braking braking;

  /// Bottom and top of the virtual corridor: the robot needs free space between them, metres above
  /// the floor.
  [[nodiscard]] double corridor_bottom_m() const { return corridor.floor_tolerance_m; }
  [[nodiscard]] double corridor_top_m() const { return body.height_m + corridor.top_margin_m; }

  template <class Visitor>
  void describe(Visitor& v) {
    v.section("robot.body", body);
    v.section("robot.mount", mount);
    v.section("robot.head", head);
    v.section("robot.corridor", corridor);
    v.section("robot.braking", braking);
    describe_former_names(v);
  }

 private:
  template <class Visitor>
  static void describe_former_names(Visitor& v) {
    v.renamed("robot_length_m", "robot.body.length_m");
    v.renamed("robot_width_m", "robot.body.width_m");
    v.renamed("robot_height_m", "robot.body.height_m");
    v.renamed("mount_x_m", "robot.mount.x_m");
    v.renamed("mount_y_m", "robot.mount.y_m");
    v.renamed("mount_z_m", "robot.mount.z_m");
    for (const char* name :
         {"pitch_min_deg", "pitch_max_deg", "pitch_rate_rad_s", "pitch_acceleration_rad_s2"}) {
      v.renamed(name, std::string("robot.head.") + name);
    }
    v.renamed("floor_tolerance_m", "robot.corridor.floor_tolerance_m");
    for (const char* name : {"head_clearance_m", "robot.corridor.head_clearance_m"}) {
      v.renamed(name, "robot.corridor.top_margin_m");
    }
    for (const char* name : {"deceleration_mps2", "emergency_deceleration_mps2", "stop_margin_m"}) {
      v.renamed(name, std::string("robot.braking.") + name);
    }
  }
};

}  // namespace nodmap::robot
