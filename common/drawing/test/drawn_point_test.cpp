// SPDX-License-Identifier: BSD-3-Clause
#include "common/drawing/drawn_point.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace nodmap::drawing {
namespace drawn_point_test {

TEST(DrawnPoint, TheHeightRangeIgnoresStrayPoints) {
  std::vector<DrawnPoint> points(1001);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].p_map = Eigen::Vector3f(0, 0, 0.01F * static_cast<float>(i));
  }
  points[0].p_map.z() = -1000.0F;  // one stray point does not use up the scale
  const HeightRange range = height_range(points);
  EXPECT_NEAR(range.place(range.low_m), 0.0, 1e-6);
  EXPECT_NEAR(range.place(range.high_m), 1.0, 1e-6);
  EXPECT_GT(range.low_m, 0.0F);
}

}  // namespace drawn_point_test
}  // namespace nodmap::drawing
