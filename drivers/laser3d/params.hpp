// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/params/robot_params.hpp"
#include "drivers/laser3d/nod.hpp"
#include "drivers/laser3d/scan_joiner.hpp"
#include "drivers/laser3d/servo/session.hpp"
#include "drivers/laser3d/sick/step.hpp"

namespace nodmap::laser3d {

/// Where the mirror is, seen from the pitch axis.
struct MirrorOffsetParams {
  double forward_m = 0.0;
  double up_m = 0.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("mirror_forward_m", forward_m, {-0.5, 0.5},
             "Mirror's centre ahead of the pitch axis, at pitch 0.");
    v.number("mirror_up_m", up_m, {-0.5, 0.5}, "Mirror's centre above the pitch axis, at pitch 0.");
  }
};

struct Laser3dParams {
  SickParams laser;
  ServoParams servo;
  params::RobotParams robot;
  NodParams nod;
  MirrorOffsetParams mirror;
  JoinerParams joiner;

  template <class Visitor>
  void describe(Visitor& v) {
    laser.describe(v);
    servo.describe(v);
    robot.describe(v);
    nod.describe(v);
    mirror.describe(v);
    joiner.describe(v);
  }
};

}  // namespace nodmap::laser3d
