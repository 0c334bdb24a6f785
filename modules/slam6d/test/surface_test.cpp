// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/surface.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace nodmap::slam6d {
namespace {

TEST(Surface, ThinAveragesWithinACubeInTheOrderMet) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Eigen::Vector3d> points{
      {1.01, 0.02, 0.03}, {-0.01, 0.0, 0.0}, {1.03, 0.04, 0.05}, {nan, 0.0, 0.0}};
  const auto thinned = thin(points, 0.1);
  ASSERT_EQ(thinned.size(), 2U);
  EXPECT_LT((thinned[0] - Eigen::Vector3d(1.02, 0.03, 0.04)).norm(), 1e-12);
  EXPECT_LT((thinned[1] - Eigen::Vector3d(-0.01, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_TRUE(thin({}, 0.1).empty());
}

TEST(Surface, ThinEvensOutTheDensity) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> near(0.0, 1.0);
  std::uniform_real_distribution<double> far(1.0, 2.0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 20'000; ++i) {
    points.emplace_back(near(random), near(random), 0.05);
  }
  for (int i = 0; i < 1'000; ++i) {
    points.emplace_back(far(random), near(random), 0.05);
  }
  std::size_t num_near = 0;
  const auto thinned = thin(points, 0.1);
  for (const Eigen::Vector3d& p : thinned) {
    num_near += p.x() < 1.0 ? 1U : 0U;
  }
  // 100 cubes each; of the thin side a cube is empty with probability e^-10.
  EXPECT_EQ(num_near, 100U);
  EXPECT_EQ(thinned.size(), 200U);
}

// A wall at x = 2 with 1 cm noise: 16 means of a 10 cm grid span 40 cm, which holds the normal to
// about 1 cm / 40 cm; 0.1 rad is four times that.
TEST(Surface, NormalsOfAWallFaceTheViewpoint) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::uniform_real_distribution<double> along(-2.0, 2.0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 20'000; ++i) {
    points.emplace_back(2.05 + noise(random), along(random), along(random));
  }
  for (const double side : {1.0, -1.0}) {
    const Eigen::Vector3d p_view(2.0 - side * 2.0, 0.0, 0.0);
    const Surface surface = extract_surface(points, p_view, {});
    ASSERT_EQ(surface.points.size(), surface.normals.size());
    for (const Eigen::Vector3d& normal : surface.normals) {
      ASSERT_FALSE(normal.isZero());
      EXPECT_GT(normal.dot(Eigen::Vector3d(-side, 0, 0)), std::cos(0.1));
    }
  }
}

TEST(Surface, NoPlaneInAHeapOrFromFewPoints) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> anywhere(-0.3, 0.3);
  std::vector<Eigen::Vector3d> heap;
  for (int i = 0; i < 5'000; ++i) {
    heap.emplace_back(anywhere(random), anywhere(random), anywhere(random));
  }
  const Surface surface = extract_surface(heap, Eigen::Vector3d(5, 0, 0), {});
  std::size_t num_planes = 0;
  for (const Eigen::Vector3d& normal : surface.normals) {
    num_planes += normal.isZero() ? 0U : 1U;
  }
  // By chance, and at the sides of the heap, a few neighbourhoods are flat.
  EXPECT_LT(num_planes, surface.normals.size() / 10);

  const std::vector<Eigen::Vector3d> few{{1, 0, 0}, {1.2, 0, 0}, {1, 0.2, 0}};
  for (const Eigen::Vector3d& normal : extract_surface(few, Eigen::Vector3d::Zero(), {}).normals) {
    EXPECT_TRUE(normal.isZero());
  }
  EXPECT_TRUE(extract_surface({}, Eigen::Vector3d::Zero(), {}).points.empty());
}

}  // namespace
}  // namespace nodmap::slam6d
