// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/fan.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

namespace nodmap::navigator {
namespace fan_test {

// A scanner off the base's axes, mounted rotated, whose mirror is off the pitch axis.
scan::Scan tilted_scan(double first_rad) {
  scan::Scan scan;
  scan.angle_first_rad = first_rad;
  scan.angle_step_rad = 0.1;
  scan.pitch_first_rad = -0.4;
  scan.pitch_last_rad = -0.3;
  scan.mirror_offset_m = {0.03, 0.0, 0.05};
  scan.T_base_mount.translation() = Eigen::Vector3d(0.15, -0.02, 0.38);
  scan.T_base_mount.linear() =
      Eigen::AngleAxisd(0.2, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  scan.ranges_m = {1.0F, 2.5F, std::numeric_limits<float>::infinity(), 0.7F};
  scan.range_max_m = 10.0;
  return scan;
}

// Oracle: Eq. 1 as the other modules compute it.
TEST(Fan, BeamsEndWhereTheScanHasItsPoints) {
  Fan fan;
  for (const double first_rad : {-0.2, 1.1}) {
    const scan::Scan scan = tilted_scan(first_rad);
    fan.take(scan);
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const Beam beam = fan.beam(scan, i, scan.T_base_mount);
      EXPECT_EQ(beam.is_hit, scan.is_hit(i));
      EXPECT_EQ(beam.range_m, static_cast<double>(scan.ranges_m[i]));
      for (const double range_m : {0.0, 2.0}) {
        EXPECT_TRUE((beam.origin + range_m * beam.direction)
                        .isApprox(scan::point_in_base(scan, i, range_m), 1e-12));
      }
    }
  }
}

TEST(Fan, ReportsWhetherTheAnglesAreOthers) {
  Fan fan;
  scan::Scan scan = tilted_scan(0.0);
  EXPECT_TRUE(fan.take(scan));
  scan.pitch_last_rad = 0.2;
  EXPECT_FALSE(fan.take(scan));
  scan.ranges_m.pop_back();
  EXPECT_TRUE(fan.take(scan));
  scan.angle_step_rad = 0.2;
  EXPECT_TRUE(fan.take(scan));
}

}  // namespace fan_test
}  // namespace nodmap::navigator
