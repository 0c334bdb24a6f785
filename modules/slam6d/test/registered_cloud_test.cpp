// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registered_cloud.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace nodmap::slam6d {
namespace registered_cloud_test {

TEST(RegisteredCloud, PointsAndNormalsAreInTheMapFrame) {
  Keyframe keyframe;
  keyframe.T_map_base.translation() = Eigen::Vector3d(10, 0, 0);
  keyframe.T_map_base.linear() =
      Eigen::AngleAxisd(geometry::kPi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  SweepCloud cloud;
  cloud.points = {{1.0F, 0.0F, 0.0F}, {5.0F, 0.0F, 0.0F}};
  keyframe.cloud = std::make_shared<const SweepCloud>(cloud);
  keyframe.points = {{.p = {1.05F, 0.0F, 0.0F}, .normal = {-1.0F, 0.0F, 0.0F}, .num_points = 1.0F}};
  const auto points = drawn_cloud(std::vector<Keyframe>{keyframe}, 10);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_LT((points[0].p_map - Eigen::Vector3f(10, 1, 0)).norm(), 1e-6F);
  EXPECT_LT((points[0].normal_map - Eigen::Vector3f(0, -1, 0)).norm(), 1e-6F);
  EXPECT_TRUE(points[1].normal_map.isZero());  // no voxel with a normal is near
  keyframe.is_moved = {false, true};
  EXPECT_EQ(drawn_cloud(std::vector<Keyframe>{keyframe}, 10).size(), 1U);
  EXPECT_TRUE(drawn_cloud({}, 10).empty());
}

// The clouds of a large building would be in memory several times while they are drawn.
TEST(RegisteredCloud, ALargeCloudIsThinnedEvenlyForDrawing) {
  Keyframe keyframe;
  SweepCloud cloud;
  for (int i = 0; i < 10; ++i) {
    cloud.points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
  }
  keyframe.cloud = std::make_shared<const SweepCloud>(cloud);
  const std::vector<Keyframe> keyframes(3, keyframe);
  EXPECT_EQ(num_registered(keyframes), 30U);
  EXPECT_EQ(drawn_cloud(keyframes, 30).size(), 30U);
  const auto points = drawn_cloud(keyframes, 8);  // each fourth point, on through the keyframes
  ASSERT_EQ(points.size(), 8U);
  EXPECT_EQ(points[2].p_map.x(), 8.0F);
  EXPECT_EQ(points[3].p_map.x(), 2.0F);
}

}  // namespace registered_cloud_test
}  // namespace nodmap::slam6d
