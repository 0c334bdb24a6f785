// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/carmen_mounts.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::convert {
namespace carmen_mounts_test {

constexpr auto kFront = LaserSide::kFront;
constexpr auto kRear = LaserSide::kRear;

double six_decimals(double value) {
  return std::round(value * 1e6) / 1e6;
}

// A scan line of a robot at this pose.
CarmenScan scan_at(const geometry::SE2& T_odom_base, const geometry::SE2& T_base_laser,
                   LaserSide side) {
  const geometry::SE2 T_odom_laser = T_odom_base * T_base_laser;
  CarmenScan scan;
  scan.side = side;
  scan.T_odom_base = T_odom_base;
  scan.T_odom_laser = {six_decimals(T_odom_laser.x), six_decimals(T_odom_laser.y),
                       six_decimals(T_odom_laser.yaw)};
  return scan;
}

TEST(CarmenMounts, AreTheOffsetsBetweenThePosesOfTheScanLines) {
  CarmenMounts mounts;
  for (int i = 0; i < 20; ++i) {
    mounts.add(scan_at({0.1 * i, 100.0 + i, 0.7 * i}, {-0.04, 0.0, 0.0}, kFront));
    mounts.add(scan_at({0.1 * i, 100.0 + i, 0.7 * i}, {-0.2, 0.01, geometry::kPi}, kRear));
  }
  EXPECT_TRUE(mounts.is_from_scans(kFront));
  EXPECT_EQ(mounts.mount(kFront).x, -0.04);  // exactly: rounded to 0.1 mm
  EXPECT_EQ(mounts.mount(kFront).y, 0.0);
  EXPECT_EQ(mounts.mount(kFront).yaw, 0.0);
  EXPECT_TRUE(mounts.is_from_scans(kRear));
  EXPECT_EQ(mounts.mount(kRear).x, -0.2);
  EXPECT_EQ(mounts.mount(kRear).yaw, geometry::kPi);
}

TEST(CarmenMounts, OffsetsThatDifferAreNotAMount) {
  CarmenMounts mounts;
  mounts.add(CarmenParameter{"robot_frontlaser_offset", "0.12"});
  mounts.add(scan_at({}, {0.0, 0.0, 0.0}, kFront));
  mounts.add(scan_at({1.0, 0.0, 0.0}, {0.05, 0.02, 0.01}, kFront));
  EXPECT_FALSE(mounts.is_from_scans(kFront));
  EXPECT_EQ(mounts.mount(kFront).x, 0.12);
}

TEST(CarmenMounts, AnImpossibleOffsetIsNotAMount) {
  CarmenMounts mounts;
  mounts.add(scan_at({}, {50.0, 0.0, 0.0}, kFront));
  mounts.add(scan_at({}, {0.0, 0.0, 0.0}, kRear));  // a rear scanner that looks ahead
  EXPECT_FALSE(mounts.is_from_scans(kFront));
  EXPECT_FALSE(mounts.is_from_scans(kRear));
  EXPECT_EQ(mounts.mount(kFront).x, 0.0);
  EXPECT_EQ(mounts.mount(kRear).yaw, geometry::kPi);
}

TEST(CarmenMounts, InvalidParametersAreIgnored) {
  CarmenMounts mounts;
  mounts.add(CarmenParameter{"robot_frontlaser_offset", "on"});
  mounts.add(CarmenParameter{"robot_rearlaser_offset", "-0.3"});
  EXPECT_EQ(mounts.mount(kFront).x, 0.0);
  EXPECT_EQ(mounts.mount(kRear).x, -0.3);
}

}  // namespace carmen_mounts_test
}  // namespace nodmap::convert
