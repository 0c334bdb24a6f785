// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/carmen.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tools/convert/carmen_writer.hpp"

namespace nodmap::convert {
namespace carmen_test {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

template <class Value>
Value parse(const std::string& line) {
  const CarmenLine parsed = parse_carmen_line(line);
  const Value* value = std::get_if<Value>(&parsed);
  EXPECT_NE(value, nullptr) << line;
  return value != nullptr ? *value : Value{};
}

void expect_same(const geometry::SE2& a, const geometry::SE2& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(geometry::angle_difference(a.yaw, b.yaw), 0.0, tolerance);
}

TEST(Carmen, ReadsOdometry) {
  const auto odometry =
      parse<CarmenOdometry>("ODOM 1.5 -2 0.25 0.3 -0.1 0 976052857.337284 nohost 0.000632");
  EXPECT_EQ(odometry.stamp, time::from_utime(976052857337284));
  expect_same(odometry.T_odom_base, {1.5, -2.0, 0.25}, 0.0);
  EXPECT_EQ(odometry.forward_mps, 0.3);
  EXPECT_EQ(odometry.yaw_rate_rad_s, -0.1);
}

TEST(Carmen, ReadsFrontAndRearScans) {
  const std::string rest = " 3 1.07 81.83 0.02 1 2 0.5 1.1 2.1 0.6 976052857.337530 nohost 0.1";
  const auto front = parse<CarmenScan>("FLASER" + rest);
  EXPECT_EQ(front.side, LaserSide::kFront);
  EXPECT_EQ(front.stamp, time::from_utime(976052857337530));
  EXPECT_EQ(front.ranges_m, (std::vector<float>{1.07F, kInfinity, 0.02F}));
  expect_same(front.T_odom_laser, {1.0, 2.0, 0.5}, 0.0);
  expect_same(front.T_odom_base, {1.1, 2.1, 0.6}, 0.0);
  EXPECT_EQ(parse<CarmenScan>("RLASER" + rest).side, LaserSide::kRear);
}

TEST(Carmen, FanFromTheNumberOfBeams) {
  for (const auto& [num_beams, first_deg, step_deg] : {std::tuple{180, -90.0, 1.0},
                                                       {181, -90.0, 1.0},
                                                       {360, -90.0, 0.5},
                                                       {361, -90.0, 0.5},
                                                       {401, -50.0, 0.25}}) {
    const CarmenFan fan = carmen_fan(static_cast<std::size_t>(num_beams));
    EXPECT_DOUBLE_EQ(geometry::rad_to_deg(fan.angle_first_rad), first_deg) << num_beams;
    EXPECT_DOUBLE_EQ(geometry::rad_to_deg(fan.angle_step_rad), step_deg) << num_beams;
  }
}

TEST(Carmen, ReadsDescribedScan) {
  const auto scan = parse<CarmenScan>(
      "ROBOTLASER1 0 -1.5 3.0 1.5 50 0.01 1 3 1 50 49.9 2 7 8 0 0 3.14 0 0 0 "
      "0.1 0.2 0.3 0.4 0.5 12.5 host 0.5");
  EXPECT_EQ(scan.angle_first_rad, -1.5);
  EXPECT_EQ(scan.angle_step_rad, 1.5);
  EXPECT_EQ(scan.range_max_m, 50.0);
  EXPECT_EQ(scan.ranges_m, (std::vector<float>{1.0F, kInfinity, 49.9F}));
  EXPECT_EQ(scan.intensities, (std::vector<float>{7.0F, 8.0F}));
  EXPECT_EQ(scan.side, LaserSide::kRear);
  EXPECT_EQ(scan.stamp, time::from_utime(12'500'000));
}

TEST(Carmen, ReadsParametersAndSkipsTheRest) {
  const auto parameter =
      parse<CarmenParameter>("PARAM robot_frontlaser_offset -0.04 1071078718.462495 merci 0");
  EXPECT_EQ(parameter.name, "robot_frontlaser_offset");
  EXPECT_EQ(parameter.value, "-0.04");
  EXPECT_EQ(parse<CarmenOther>("").name, "");
  EXPECT_EQ(parse<CarmenOther>("# FLASER 180 1 2 3").name, "");
  EXPECT_EQ(parse<CarmenOther>("TRUEPOS 1 2 3 4 5 6 7.0 host 8").name, "TRUEPOS");
}

TEST(Carmen, DamagedLinesAreUnreadable) {
  for (const char* line :
       {"ODOM", "ODOM 1 2 3", "ODOM 1 2 x 0 0 0 1.0 host 1.0", "ODOM 1 2 nan 0 0 0 1.0 host 1.0",
        "ODOM 1 2 3 0 0 0 1e13 host 1.0", "ODOM 1 2 3 0 0 0 1.0 host 1.0 more", "FLASER",
        "FLASER -1 1 2 0 0 0 0 0 0 1.0 host 1.0", "FLASER 0 0 0 0 0 0 0 1.0 host 1.0",
        "FLASER 1 1 0 0 0 0 0 0 1.0 host 1.0",
        // A count that is too large or too small shifts every word after it.
        "FLASER 4 1 2 3 0 0 0 0 0 0 1.0 host 1.0", "FLASER 2 1 2 3 0 0 0 0 0 0 1.0 host 1.0",
        "FLASER 3 1 2 3 0 0 0 0 0",
        "ROBOTLASER1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1.0 h 1.0"}) {
    EXPECT_FALSE(parse<CarmenUnreadable>(line).why.empty()) << line;
  }
}

TEST(CarmenWriter, LinesReadBackTheSame) {
  CarmenOdometry odometry{time::from_utime(976052857337284), {1.25, -2.5, 3.0}, 0.5, -0.25};
  const auto odometry_back =
      parse<CarmenOdometry>(write_carmen_line(odometry, time::from_utime(976052857000000)));
  EXPECT_EQ(odometry_back.stamp, odometry.stamp);
  expect_same(odometry_back.T_odom_base, odometry.T_odom_base, 1e-6);  // six decimals
  EXPECT_EQ(odometry_back.forward_mps, 0.5);
  EXPECT_EQ(odometry_back.yaw_rate_rad_s, -0.25);

  CarmenScan scan;
  scan.stamp = time::from_utime(7);
  scan.angle_first_rad = carmen_fan(3).angle_first_rad;
  scan.angle_step_rad = carmen_fan(3).angle_step_rad;
  scan.ranges_m = {1.0F / 3.0F, kInfinity, 79.99F};
  for (const LaserSide side : {LaserSide::kFront, LaserSide::kRear}) {
    scan.side = side;
    const std::string line = write_carmen_line(scan, {});
    EXPECT_TRUE(line.starts_with(side == LaserSide::kFront ? "FLASER" : "RLASER")) << line;
    const auto back = parse<CarmenScan>(line);
    EXPECT_EQ(back.stamp, time::from_utime(7));
    EXPECT_EQ(back.side, side);
    EXPECT_EQ(back.ranges_m, scan.ranges_m);
  }
}

TEST(CarmenWriter, OtherFansGoIntoADescribedLine) {
  CarmenScan scan;
  scan.stamp = time::from_utime(1'000'000);
  scan.angle_first_rad = -2.0;
  scan.angle_step_rad = 0.1;
  scan.range_max_m = 5.6;
  scan.ranges_m = {1.0F, kInfinity, 2.0F};
  scan.intensities = {3.0F};
  const std::string line = write_carmen_line(scan, {});
  EXPECT_TRUE(line.starts_with("ROBOTLASER1 ")) << line;
  const auto back = parse<CarmenScan>(line);
  EXPECT_EQ(back.angle_first_rad, scan.angle_first_rad);
  EXPECT_EQ(back.angle_step_rad, scan.angle_step_rad);
  EXPECT_EQ(back.range_max_m, scan.range_max_m);
  EXPECT_EQ(back.ranges_m, scan.ranges_m);
  EXPECT_EQ(back.intensities, scan.intensities);
}

// A laser that is mounted upside down: its beams go to the right.
TEST(CarmenWriter, AScanFromLeftToRightIsWrittenFromRightToLeft) {
  CarmenScan scan;
  scan.angle_first_rad = 1.5;
  scan.angle_step_rad = -0.5;
  scan.range_max_m = 5.6;
  scan.ranges_m = {1.0F, kInfinity, 2.0F};
  scan.intensities = {7.0F, 8.0F, 9.0F};
  const auto back = parse<CarmenScan>(write_carmen_line(scan, {}));
  EXPECT_EQ(back.angle_first_rad, 0.5);
  EXPECT_EQ(back.angle_step_rad, 0.5);
  EXPECT_EQ(back.ranges_m, (std::vector<float>{2.0F, kInfinity, 1.0F}));
  EXPECT_EQ(back.intensities, (std::vector<float>{9.0F, 8.0F, 7.0F}));
  // The fan of a SICK gets its usual line.
  const CarmenFan fan = carmen_fan(3);
  scan.angle_first_rad = -fan.angle_first_rad;
  scan.angle_step_rad = -fan.angle_step_rad;
  scan.range_max_m = kCarmenNoReturnM;
  scan.intensities = {};
  const std::string line = write_carmen_line(scan, {});
  EXPECT_TRUE(line.starts_with("FLASER ")) << line;
  EXPECT_EQ(parse<CarmenScan>(line).ranges_m, back.ranges_m);
}

}  // namespace carmen_test
}  // namespace nodmap::convert
