// SPDX-License-Identifier: BSD-3-Clause
// make_robot_log FILE [DURATION_S [POINTS_PER_KEYFRAME]]: writes the log of an imaginary robot for
// the process tests.
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "modules/viewer/foxglove/test/robot_log.hpp"

int main(int argc, char** argv) {
  try {
    nodmap::foxglove::test::RobotLog settings;
    if (argc > 2) {
      settings.duration_s = std::atof(argv[2]);
    }
    if (argc > 3) {
      settings.points_per_keyframe = std::atoi(argv[3]);
    }
    nodmap::foxglove::test::write_robot_log(argc > 1 ? argv[1] : "robot.lcmlog", settings);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_robot_log: %s\n", error.what());
    return 1;
  }
}
