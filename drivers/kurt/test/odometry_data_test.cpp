// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "drivers/kurt/odometry.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::kurt {
namespace odometry_data_test {

// Two KURTs with their wheels in the air, up to the full duty cycle: all measured ticks are
// plausible.
TEST(OdometryData, MeasuredWheelSpeedsArePlausible) {
  NODMAP_REQUIRE_DATA(dir, "kurt");
  for (const char* name : {"speed-pwm-leerlauf-kyoto.dat", "speed-pwm-leerlauf-osaka.dat"}) {
    std::ifstream in(dir / name);
    double time_ms = 0.0;
    double mean_mps = 0.0;
    double left_mps = 0.0;
    double right_mps = 0.0;
    int pwm = 0;
    int lines = 0;
    WheelParams wheels;  // 1 tick is 1 mm
    wheels.perimeter_m = 1.0;
    wheels.ticks_per_revolution = 1000;
    Odometry odometry(wheels, {});
    while (in >> time_ms >> mean_mps >> left_mps >> right_mps >> pwm) {
      EXPECT_TRUE(odometry.add({static_cast<int>(std::lround(10.0 * left_mps)),
                                static_cast<int>(std::lround(10.0 * right_mps))}));
      ++lines;
    }
    EXPECT_GT(lines, 1000) << name;
  }
}

}  // namespace odometry_data_test
}  // namespace nodmap::kurt
