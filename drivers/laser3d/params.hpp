// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/robot/robot_params.hpp"
#include "drivers/laser3d/nod.hpp"
#include "drivers/laser3d/scan_joiner.hpp"
#include "drivers/laser3d/servo/session.hpp"
#include "drivers/laser3d/sick/step.hpp"

namespace nodmap::laser3d {

/// The position of the mirror relative to the pitch axis.
struct MirrorOffsetParams {
  double forward_m = 0.0;
  double up_m = 0.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("forward_m", forward_m, {-0.5, 0.5},
             "Distance of the mirror's centre ahead of the pitch axis, at pitch 0.");
    v.number("up_m", up_m, {-0.5, 0.5},
             "Height of the mirror's centre above the pitch axis, at pitch 0.");
  }
};

struct Laser3dParams {
  SickParams laser;
  ServoParams servo;
  robot::RobotParams robot;
  NodParams nod;
  MirrorOffsetParams mirror;
  JoinerParams joiner;

  template <class Visitor>
  void describe(Visitor& v) {
    v.section("laser", laser);
    v.section("servo", servo);
    robot.describe(v);
    v.section("nod", nod);
    v.section("mirror", mirror);
    v.section("joiner", joiner);
    describe_renamed(v);
  }

 private:
  template <class Visitor>
  static void describe_renamed(Visitor& v) {
    for (const char* key : {"device", "baud", "time_offset_s"}) {
      v.renamed(std::string("laser_") + key, std::string("laser.") + key);
    }
    for (const char* key : {"variant", "interlaced", "unit", "reach", "range_min_m", "range_max_m",
                            "upside_down", "frozen_scans"}) {
      v.renamed(key, std::string("laser.") + key);
    }
    v.renamed("servo", "servo.kind");
    for (const char* key : {"device", "baud", "id", "poll_hz"}) {
      v.renamed(std::string("servo_") + key, std::string("servo.") + key);
    }
    v.renamed("servo_level_position", "servo.dynamixel.level_position");
    v.renamed("servo_inverted", "servo.dynamixel.inverted");
    v.renamed("maestro_level_us", "servo.maestro.level_us");
    v.renamed("maestro_us_per_deg", "servo.maestro.us_per_deg");
    for (const char* key :
         {"default_min_deg", "default_max_deg", "default_sweep_s", "command_timeout_s"}) {
      v.renamed(key, std::string("nod.") + key);
    }
    v.renamed("mirror_forward_m", "mirror.forward_m");
    v.renamed("mirror_up_m", "mirror.up_m");
    v.renamed("max_extrapolation_s", "joiner.max_extrapolation_s");
  }
};

/// Checks what the limits of single parameters cannot express, such as a nod whose lower end is
/// above its upper one. Throws params::ParamError, which names the parameter.
void check(const Laser3dParams& params);

/// Checks that the parameters name both serial ports. Throws params::ParamError.
void check_devices(const Laser3dParams& params);

}  // namespace nodmap::laser3d
