// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sim/plant_params.hpp"
#include "sim/robot.hpp"

namespace nodmap::sim {

/// What can be set about the simulated robot: the plant, and how its devices differ from the ideal.
struct SimParams {
  PlantParams plant;
  RobotSettings robot;

  template <class Visitor>
  void describe(Visitor& v) {
    plant.describe(v);
    v.choice("laser_power_on_baud", robot.laser.baud,
             {{"9600", 9600}, {"19200", 19200}, {"38400", 38400}, {"500000", 500000}},
             "Rate of the laser after power-on; another than 9600 was made permanent.");
    v.number("laser_boot_s", robot.laser.boot_s, {0.0, 60.0},
             "From power-on to the laser's first word.");
    v.number("mirror_ppm", robot.laser.mirror_ppm, {-2000.0, 2000.0},
             "By how many millionths the mirror turns too slowly.");
    v.flag("laser_polluted", robot.laser.polluted, "The laser says that its window is dirty.");
    v.number("servo_clock_ppm", robot.servo.clock_ppm, {-2000.0, 2000.0},
             "By how many millionths the servo's clock goes too fast.");
    v.integer("servo_level_position", robot.servo.level_position, {0, 4095},
              "Position of the servo at which the laser looks straight ahead.");
    v.flag("servo_inverted", robot.servo.inverted, "Larger positions of the servo look down.");
    v.flag("servo_echo", robot.servo.echo, "The servo's adapter returns the host's own bytes.");
    v.number("base_clock_ppm", robot.base.base.clock_ppm, {-2000.0, 2000.0},
             "By how many millionths the base's clock goes too slowly.");
  }
};

}  // namespace nodmap::sim
