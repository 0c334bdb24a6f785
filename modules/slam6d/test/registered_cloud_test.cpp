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
  const auto points = registered_cloud(std::vector<Keyframe>{keyframe});
  ASSERT_EQ(points.size(), 2U);
  EXPECT_LT((points[0].p_map - Eigen::Vector3f(10, 1, 0)).norm(), 1e-6F);
  EXPECT_LT((points[0].normal_map - Eigen::Vector3f(0, -1, 0)).norm(), 1e-6F);
  EXPECT_TRUE(points[1].normal_map.isZero());  // no voxel with a normal is near
  keyframe.is_moved = {false, true};
  EXPECT_EQ(registered_cloud(std::vector<Keyframe>{keyframe}).size(), 1U);
  EXPECT_TRUE(registered_cloud({}).empty());
}

}  // namespace registered_cloud_test
}  // namespace nodmap::slam6d
