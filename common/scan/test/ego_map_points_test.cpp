// SPDX-License-Identifier: BSD-3-Clause
#include "common/scan/ego_map_points.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace nodmap::scan {
namespace ego_map_points_test {

TEST(EgoMapPoints, AnInconsistentMapIsRefused) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  constexpr auto kFar = std::numeric_limits<float>::infinity();
  using Bins = std::vector<float>;
  const auto points = read_ego_map_points(Bins{kFar, 5.0F}, Bins{kNone, 3.0F}, Bins{kNone, 4.0F});
  ASSERT_TRUE(points);
  EXPECT_EQ(*points, (std::vector<Eigen::Vector2d>{{3.0, 4.0}}));
  EXPECT_FALSE(read_ego_map_points(Bins{kNone}, Bins{1.0F}, Bins{0.0F}));
  EXPECT_FALSE(read_ego_map_points(Bins{1.0F}, Bins{kNone}, Bins{0.0F}));
  EXPECT_FALSE(read_ego_map_points(Bins{-1.0F}, Bins{1.0F}, Bins{0.0F}));
  EXPECT_FALSE(read_ego_map_points(Bins{-kFar}, Bins{kNone}, Bins{kNone}));
  EXPECT_FALSE(read_ego_map_points(Bins{2.0F}, Bins{1.0F}, Bins{0.0F}));
  EXPECT_FALSE(read_ego_map_points(Bins{1.0F, 1.0F}, Bins{1.0F}, Bins{0.0F}));
  EXPECT_FALSE(read_ego_map_points({}, {}, {}));
}

}  // namespace ego_map_points_test
}  // namespace nodmap::scan
