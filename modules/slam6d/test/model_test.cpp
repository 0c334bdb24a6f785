// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/model.hpp"

#include <gtest/gtest.h>

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

Surface row(double first_x_m, int count) {
  Surface surface;
  for (int i = 0; i < count; ++i) {
    surface.points.emplace_back(first_x_m + 0.2 * i, 0.0, 0.0);
    surface.normals.emplace_back(0.0, 0.0, 1.0);
  }
  return surface;
}

TEST(Model, R36_AddsOnlyPointsWithoutAPartner) {
  Model model(0.1);
  model.add(row(0.0, 10), SE3::Identity());
  EXPECT_EQ(model.points().size(), 10U);
  model.add(row(0.0, 10), SE3::Identity());  // standing: nothing new
  EXPECT_EQ(model.points().size(), 10U);
  SE3 T_map_base = SE3::Identity();
  T_map_base.translation().x() = 1.0 + 0.05;  // within the spacing of five of them
  model.add(row(0.0, 10), T_map_base);
  EXPECT_EQ(model.points().size(), 15U);
}

TEST(Model, NearestIsInMapWithItsNormalTurned) {
  Model model(0.1);
  SE3 T_map_base = SE3::Identity();
  T_map_base.linear() =
      Eigen::AngleAxisd(geometry::kPi / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  T_map_base.translation() = Eigen::Vector3d(5, 0, 0);
  model.add(row(0.0, 3), T_map_base);
  const auto partner = model.nearest({5.05, 0, 0}, 0.1);
  ASSERT_TRUE(partner);
  EXPECT_LT((partner->p_map - Eigen::Vector3d(5, 0, 0)).norm(), 1e-12);
  EXPECT_LT((partner->normal_map - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12);
  EXPECT_FALSE(model.nearest({5.05, 0, 1}, 0.1));
}

TEST(Model, EmptySurface) {
  Model model(0.1);
  model.add({}, SE3::Identity());
  EXPECT_TRUE(model.points().empty());
  EXPECT_FALSE(model.nearest({0, 0, 0}, 1.0));
}

}  // namespace
}  // namespace nodmap::slam6d
