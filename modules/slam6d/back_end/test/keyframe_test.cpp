// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/keyframe.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace nodmap::slam6d {
namespace keyframe_test {

// A dense wall, which has planes at the finest level, and a sparse one, which has coarse ones. The
// adjustment gets what the voxels of the cloud themselves would give.
TEST(Keyframe, KeepsThePlanesThatItsVoxelsSelect) {
  std::vector<Eigen::Vector3f> points;
  for (const auto& [x_m, spacing_m] : {std::pair{2.0F, 0.02F}, std::pair{4.0F, 0.3F}}) {
    for (float y_m = -1.0F; y_m < 1.0F; y_m += spacing_m) {
      for (float z_m = -1.0F; z_m < 1.0F; z_m += spacing_m) {
        points.emplace_back(x_m, y_m, z_m);
      }
    }
  }
  const VoxelMap voxels = VoxelMap::from_points(points, Eigen::Vector3f::Zero(), {});
  Keyframe keyframe;
  keyframe.keep_voxels(voxels);
  const VoxelMap::Selection selected = voxels.select(0);
  ASSERT_GT(selected.first_of_level[1], 0U);
  ASSERT_GT(selected.points.size(), selected.first_of_level[1]);
  const std::vector<OrientedPoint> planes = keyframe.planes();
  ASSERT_EQ(planes.size(), selected.points.size());
  for (std::size_t i = 0; i < planes.size(); ++i) {
    EXPECT_EQ(planes[i].p, selected.points[i].p);
    EXPECT_EQ(planes[i].normal, selected.points[i].normal);
  }
}

}  // namespace keyframe_test
}  // namespace nodmap::slam6d
