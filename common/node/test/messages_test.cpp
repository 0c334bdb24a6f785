// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/messages.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace nodmap::node {
namespace messages_test {

using geometry::SE3;

scan::Scan sample_scan() {
  scan::Scan scan;
  scan.stamp = time::from_utime(1);
  scan.duration = 6667us;
  scan.seq = 9;
  scan.angle_first_rad = -1.5;
  scan.angle_step_rad = 0.0175;
  scan.pitch_first_rad = -0.2;
  scan.pitch_last_rad = -0.19;
  scan.pitch_measured = false;
  scan.range_min_m = 0.1;
  scan.range_max_m = 8.0;
  scan.T_base_mount = geometry::make_se3(
      {0.1, 0.0, 0.38}, Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ())));
  scan.mirror_offset_m = {0.08, 0.0, 0.01};
  scan.ranges_m = {1.0F, std::numeric_limits<float>::infinity(), 3.0F};
  return scan;
}

TEST(Messages, ScanRoundTrip) {
  const scan::Scan scan = sample_scan();
  scan::Scan back;
  ASSERT_TRUE(read_scan(write_scan(scan), back));
  EXPECT_EQ(back.stamp, scan.stamp);
  EXPECT_EQ(back.duration, scan.duration);
  EXPECT_EQ(back.seq, scan.seq);
  EXPECT_EQ(back.pitch_first_rad, scan.pitch_first_rad);
  EXPECT_EQ(back.pitch_last_rad, scan.pitch_last_rad);
  EXPECT_FALSE(back.pitch_measured);
  EXPECT_EQ(back.ranges_m, scan.ranges_m);
  EXPECT_EQ(back.mirror_offset_m, scan.mirror_offset_m);
  EXPECT_TRUE(back.T_base_mount.isApprox(scan.T_base_mount, 1e-12));  // roundings of a quaternion
}

TEST(Messages, ImplausibleScansAreRefused) {
  scan::Scan scan;
  nodmap::scan_t message = write_scan(sample_scan());
  message.num_ranges = 2;  // does not match
  EXPECT_FALSE(read_scan(message, scan));
  message = write_scan(sample_scan());
  message.mount_orientation[0] = message.mount_orientation[3] = 0.0;  // no rotation
  EXPECT_FALSE(read_scan(message, scan));
  message = write_scan(sample_scan());
  message.pitch_first_rad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(read_scan(message, scan));
  message = nodmap::scan_t{};  // never filled in
  EXPECT_FALSE(read_scan(message, scan));
}

// Such values would need too much memory, or overflow cell indices of 32 bits.
TEST(Messages, PositionsAndScansTooLargeAreRefused) {
  scan::Scan scan;
  nodmap::scan_t message = write_scan(sample_scan());
  message.num_ranges = 1'000'000;
  message.ranges_m.resize(1'000'000);
  EXPECT_FALSE(read_scan(message, scan));
  message = write_scan(sample_scan());
  message.range_max_m = 1e30;
  EXPECT_FALSE(read_scan(message, scan));
  message = write_scan(sample_scan());
  message.mirror_offset_m[1] = -1e63;
  EXPECT_FALSE(read_scan(message, scan));
  nodmap::odometry_t odometry = write_odometry(time::from_utime(1), SE3::Identity());
  odometry.position_m[1] = -1.01e6;
  EXPECT_FALSE(read_odometry(odometry));
  odometry.position_m[1] = -1e6;
  EXPECT_TRUE(read_odometry(odometry));
}

// Whichever component it is: a comparison with the greatest one may pass over it.
TEST(Messages, APositionThatIsNotANumberIsRefused) {
  for (int axis = 0; axis < 3; ++axis) {
    nodmap::odometry_t odometry = write_odometry(time::from_utime(1), SE3::Identity());
    odometry.position_m[axis] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(read_odometry(odometry)) << axis;
  }
}

TEST(Messages, AScanWithoutBeamsIsAccepted) {
  scan::Scan empty = sample_scan();
  empty.ranges_m.clear();
  scan::Scan back;
  EXPECT_TRUE(read_scan(write_scan(empty), back));
  EXPECT_TRUE(back.ranges_m.empty());
}

TEST(Messages, OdometryRoundTripAndRefusal) {
  const SE3 pose = geometry::make_se3(
      {1, 2, 3}, Eigen::Quaterniond(Eigen::AngleAxisd(3.0, Eigen::Vector3d(1, 1, 0).normalized())));
  nodmap::odometry_t message = write_odometry(time::from_utime(77), pose);
  EXPECT_EQ(message.utime, 77);
  EXPECT_TRUE(std::isnan(message.pose_covariance[0][0]));
  ASSERT_TRUE(read_odometry(message).has_value());
  EXPECT_TRUE(read_odometry(message)->isApprox(pose, 1e-12));
  message.position_m[1] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(read_odometry(message).has_value());
  EXPECT_FALSE(read_odometry(nodmap::odometry_t{}).has_value());
}

TEST(Messages, AMatrixIsHeldRowByRow) {
  double rows[2][2] = {};
  write_matrix((Eigen::Matrix2d() << 1.0, 2.0, 3.0, 4.0).finished(), rows);
  EXPECT_EQ(rows[0][1], 2.0);
  EXPECT_EQ(rows[1][0], 3.0);
  EXPECT_EQ(read_matrix(rows)(0, 1), 2.0);
  EXPECT_EQ(read_matrix(rows)(1, 0), 3.0);
}

TEST(Messages, CorrectedPoseCarriesBothFrames) {
  const SE3 T_map_base = geometry::to_se3({1, 2, 0.5});
  const SE3 T_map_odom = geometry::to_se3({0.1, 0, 0.01});
  const nodmap::pose_t message = write_corrected_pose(time::from_utime(5), T_map_base, T_map_odom);
  EXPECT_TRUE(read_pose(message.position_m, message.orientation)->isApprox(T_map_base, 1e-12));
  EXPECT_TRUE(
      read_pose(message.odom_position_m, message.odom_orientation)->isApprox(T_map_odom, 1e-12));
}

// Any process can send any bytes as its name; they are logged, and repeated in other messages.
TEST(Messages, NamesOfRequestersAreShortAndPrintable) {
  EXPECT_EQ(read_name("nodmap-stop, for ~ me"), "nodmap-stop, for ~ me");
  EXPECT_EQ(read_name("a\n\x1b[2J\xff\x7f"), "a??[2J??");
  EXPECT_EQ(read_name(std::string(250'000, 'x')), std::string(100, 'x'));
}

}  // namespace messages_test
}  // namespace nodmap::node
