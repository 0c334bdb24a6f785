// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/uos_export.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <random>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "common/formats/user_error.hpp"
#include "common/node/messages.hpp"
#include "nodmap/keyframe_6d_t.hpp"
#include "tests/support/data_dir.hpp"
#include "tools/convert/uos.hpp"

namespace nodmap::convert {
namespace uos_export_test {

TEST(UosPose, IsTheInverseOfReadingOne) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 100; ++i) {
    geometry::SE3 pose = geometry::SE3::Identity();
    pose.linear() = geometry::rotation_of({normal(random), normal(random), normal(random)});
    pose.translation() = Eigen::Vector3d(normal(random), normal(random), normal(random));
    const UosPose written = to_uos_pose(pose);
    // The arc sine near 90 degrees has half the digits of its argument.
    EXPECT_TRUE(from_uos_pose(written.position_cm, written.euler_deg).isApprox(pose, 1e-7)) << i;
  }
}

void write_keyframe(bus::LogWriter& log, const geometry::SE3& T_map_base) {
  nodmap::keyframe_6d_t keyframe{};
  node::write_pose(T_map_base, keyframe.position_m, keyframe.orientation);
  keyframe.num_points = 2;
  keyframe.x_m = {1.0F, 2.5F};
  keyframe.y_m = {-0.5F, 0.25F};
  keyframe.z_m = {0.1F, 1.75F};
  std::vector<std::byte> bytes;
  bus::encode_into(bytes, keyframe);
  ASSERT_TRUE(log.write(0, "KEYFRAME_6D", bytes));
}

TEST(UosExport, WritesAScanAndItsPoseForEachKeyframe) {
  const test::TemporaryDir dir;
  geometry::SE3 pose = geometry::SE3::Identity();
  pose.linear() = geometry::rotation_of({0.1, -0.2, 0.7});
  pose.translation() = Eigen::Vector3d(3.0, -1.0, 0.5);
  {
    bus::LogWriter log(dir.path() / "keyframes.lcmlog");
    write_keyframe(log, geometry::SE3::Identity());
    write_keyframe(log, pose);
  }
  export_uos(dir.path(), dir.path() / "scans");
  std::ifstream points(dir.path() / "scans" / "scan001.3d");
  Eigen::Vector3d p_cm;
  ASSERT_TRUE(points >> p_cm.x() >> p_cm.y() >> p_cm.z());
  EXPECT_TRUE(from_uos(p_cm).isApprox(Eigen::Vector3d(1.0, -0.5, 0.1), 1e-6)) << p_cm;
  std::ifstream text(dir.path() / "scans" / "scan001.pose");
  UosPose read;
  ASSERT_TRUE(text >> read.position_cm.x() >> read.position_cm.y() >> read.position_cm.z() >>
              read.euler_deg.x() >> read.euler_deg.y() >> read.euler_deg.z());
  // Written to a millionth of a degree.
  EXPECT_TRUE(from_uos_pose(read.position_cm, read.euler_deg).isApprox(pose, 1e-6));
  EXPECT_FALSE(std::filesystem::exists(dir.path() / "scans" / "scan002.3d"));
}

TEST(UosExport, SaysWhatItCannotDo) {
  const test::TemporaryDir dir;
  {
    bus::LogWriter log(dir.path() / "keyframes.lcmlog");
    std::vector<std::byte> bytes(4);
    ASSERT_TRUE(log.write(0, "SCAN", bytes));
  }
  EXPECT_THROW(export_uos(dir.path(), dir.path() / "scans"), formats::UserError);
  EXPECT_THROW(export_uos(dir.path(), dir.path()), formats::UserError);
  EXPECT_THROW(export_uos(dir.path(), dir.path() / "none" / "scans"), formats::UserError);
  // The corrected command must not find the folder of the failed one.
  const std::filesystem::directory_iterator files(dir.path());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1) << "only the log";
}

}  // namespace uos_export_test
}  // namespace nodmap::convert
