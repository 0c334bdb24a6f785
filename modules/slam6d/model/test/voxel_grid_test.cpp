// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/model/voxel_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <tuple>
#include <vector>

namespace nodmap::slam6d {
namespace voxel_grid_test {

using Eigen::Vector3f;

std::vector<Vector3f> random_points(std::size_t n, float extent_m, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(-extent_m, extent_m);
  std::vector<Vector3f> points;
  for (std::size_t i = 0; i < n; ++i) {
    points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  }
  return points;
}

// The oracle: a std::map from the floored coordinates to the sum and the number of points.
TEST(VoxelGrid, MeansEqualThoseOfAnOrderedMap) {
  const auto points = random_points(20'000, 2.0F, 1);
  VoxelGrid grid(0.25);  // a power of two: no rounding at the borders
  grid.add(points);
  std::map<std::tuple<int, int, int>, std::pair<Eigen::Vector3d, int>> expected;
  for (const Vector3f& p : points) {
    const auto index = [](float x) { return static_cast<int>(std::floor(x / 0.25F)); };
    auto& [sum, count] =
        expected.try_emplace({index(p.x()), index(p.y()), index(p.z())}, Eigen::Vector3d::Zero(), 0)
            .first->second;
    sum += p.cast<double>();
    ++count;
  }
  ASSERT_EQ(grid.voxels().size(), expected.size());
  for (const Voxel& voxel : grid.voxels()) {
    const auto index = [](float x) { return static_cast<int>(std::floor(x / 0.25F)); };
    const auto& [sum, count] =
        expected.at({index(voxel.mean.x()), index(voxel.mean.y()), index(voxel.mean.z())});
    EXPECT_EQ(voxel.weight, static_cast<float>(count));
    // Some 5 floats of up to 2 m are added, which rounds by a few units in the last place.
    EXPECT_LT((voxel.mean.cast<double>() - sum / count).norm(), 2e-6);
  }
}

TEST(VoxelGrid, AddingInPartsEqualsAddingAtOnce) {
  const auto points = random_points(5'000, 1.0F, 2);
  VoxelGrid whole(0.1);
  whole.add(points);
  VoxelGrid parts(0.1);
  parts.add(std::span(points).first(2'000));
  parts.add(std::span(points).subspan(2'000));
  VoxelGrid singly(0.1);
  for (const Vector3f& p : points) {
    singly.add(p, 1.0F);
  }
  ASSERT_EQ(whole.voxels().size(), parts.voxels().size());
  ASSERT_EQ(whole.voxels().size(), singly.voxels().size());
  for (std::size_t i = 0; i < whole.voxels().size(); ++i) {
    // Rounding of floats of up to 1 m.
    EXPECT_LT((whole.voxels()[i].mean - parts.voxels()[i].mean).norm(), 1e-6F);
    EXPECT_LT((whole.voxels()[i].mean - singly.voxels()[i].mean).norm(), 1e-6F);
  }
}

// The oracle: brute force. Every mean within half a voxel must be found, and none beyond the limit.
TEST(VoxelGrid, NearestIsTheBruteForceNearest) {
  VoxelGrid grid(0.2);
  grid.add(random_points(4'000, 1.5F, 3));
  std::size_t num_found = 0;
  for (const Vector3f& p : random_points(2'000, 1.6F, 4)) {
    std::uint32_t best = VoxelGrid::kNone;
    float best_m = 0.1F;
    for (std::uint32_t i = 0; i < grid.voxels().size(); ++i) {
      const float distance_m = (grid.voxels()[i].mean - p).norm();
      if (distance_m < best_m) {
        best_m = distance_m;
        best = i;
      }
    }
    EXPECT_EQ(grid.nearest(p, 0.1F), best);
    num_found += best == VoxelGrid::kNone ? 0 : 1;
  }
  EXPECT_GT(num_found, 500U);
}

// The oracle: brute force up to 0.4 of a voxel. If the point moves by less than the slack, the same
// mean stays the nearest; if it moves farther, another one may become the nearest.
TEST(VoxelGrid, WithinTheSlackTheNearestStaysTheSame) {
  VoxelGrid grid(0.2);
  grid.add(random_points(4'000, 1.5F, 3));
  const std::vector<Vector3f> directions = random_points(2'000, 1.0F, 5);
  std::size_t num_checked = 0;
  std::size_t num_changed_beyond = 0;
  std::size_t i = 0;
  for (const Vector3f& p : random_points(2'000, 1.6F, 4)) {
    const VoxelGrid::Nearest found = grid.find_nearest(p, 0.3F);
    EXPECT_EQ(found.place, grid.nearest(p, 0.3F));
    EXPECT_GE(found.slack_m, 0.0F);
    EXPECT_LE(found.slack_m, 0.1F * 0.2F);
    const auto brute_nearest = [&grid](const Vector3f& q) {
      std::uint32_t best = VoxelGrid::kNone;
      float best_m = 0.4F * 0.2F;
      for (std::uint32_t j = 0; j < grid.voxels().size(); ++j) {
        const float distance_m = (grid.voxels()[j].mean - q).norm();
        if (distance_m < best_m) {
          best_m = distance_m;
          best = j;
        }
      }
      return best;
    };
    const Vector3f direction = directions[i++].normalized();
    const std::uint32_t best = brute_nearest(p + 0.999F * found.slack_m * direction);
    if (best != VoxelGrid::kNone) {
      EXPECT_EQ(found.place, best);
      ++num_checked;
    }
    num_changed_beyond += brute_nearest(p + 3.0F * found.slack_m * direction) != found.place &&
                                  best != VoxelGrid::kNone
                              ? 1
                              : 0;
  }
  EXPECT_GT(num_checked, 200U);
  EXPECT_GT(num_changed_beyond, 10U);
}

TEST(VoxelGrid, PointsThatAreNotFiniteOrTooFarAreLeftOut) {
  VoxelGrid grid(0.1);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const std::vector<Vector3f> points{
      {nan, 0, 0}, {0, infinity, 0}, {0, 0, -infinity}, {1e9F, 0, 0}, {0, nan, 1e30F}};
  grid.add(points);
  for (const Vector3f& p : points) {
    EXPECT_EQ(grid.add(p, 1.0F), VoxelGrid::kNone);
    EXPECT_EQ(grid.nearest(p, 1e9F), VoxelGrid::kNone);
  }
  grid.find_planes(Vector3f::Zero(), {});
  EXPECT_TRUE(grid.voxels().empty());
  grid.add(std::vector<Vector3f>{{90'000.0F, -90'000.0F, 0.0F}});  // nearly 100 km: still a place
  EXPECT_EQ(grid.voxels().size(), 1U);
}

// A slanting plane with 1 cm of noise: every voxel away from its edges must have the plane's
// normal, towards the sensor.
TEST(VoxelGrid, FindsThePlaneOfAWall) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> along(-1.0F, 1.0F);
  std::normal_distribution<float> noise(0.0F, 0.01F);
  const Vector3f normal = Vector3f(-1.0F, 0.3F, 0.2F).normalized();
  const Vector3f u = normal.unitOrthogonal();
  const Vector3f v = normal.cross(u);
  std::vector<Vector3f> points;
  for (int i = 0; i < 20'000; ++i) {
    points.push_back(Vector3f(3.0F, 0.0F, 0.0F) + along(random) * u + along(random) * v +
                     noise(random) * normal);
  }
  VoxelGrid grid(0.1);
  grid.add(points);
  grid.find_planes(Vector3f::Zero(), {});
  std::size_t num_inner = 0;
  for (const Voxel& voxel : grid.voxels()) {
    const Vector3f offset = voxel.mean - Vector3f(3.0F, 0.0F, 0.0F);
    if (std::abs(offset.dot(u)) > 0.8F || std::abs(offset.dot(v)) > 0.8F) {
      continue;
    }
    ++num_inner;
    ASSERT_TRUE(voxel.has_plane());
    // A normal comes from nine or more means over +-0.1 m, each with 1 cm / sqrt(20 points) of
    // noise: 0.5 degrees. But where the plane cuts the corner of a voxel there are few points.
    // Measured: the worst of some 300 normals is off by 3.7 degrees.
    EXPECT_GT(voxel.normal.dot(normal), std::cos(1.25F * 0.065F));
  }
  EXPECT_GT(num_inner, 200U);
}

TEST(VoxelGrid, AClusterInSpaceHasNoPlane) {
  VoxelGrid grid(0.1);
  grid.add(random_points(50'000, 0.5F, 6));
  grid.find_planes(Vector3f(5.0F, 0.0F, 0.0F), {});
  std::size_t num_planes = 0;
  for (const Voxel& voxel : grid.voxels()) {
    num_planes += voxel.has_plane() && voxel.mean.cwiseAbs().maxCoeff() < 0.3F ? 1 : 0;
  }
  EXPECT_EQ(num_planes, 0U);
}

// The closed form for two values: their mean, weighted by inverse variance.
TEST(VoxelGrid, MeansAndNormalsAreWeighted) {
  VoxelGrid grid(1.0);
  const std::uint32_t place = grid.add({0.2F, 0.5F, 0.5F}, 1.0F);
  EXPECT_EQ(grid.add({0.6F, 0.5F, 0.5F}, 3.0F), place);
  EXPECT_FLOAT_EQ(grid.voxels()[place].mean.x(), 0.5F);
  EXPECT_EQ(grid.voxels()[place].weight, 4.0F);
  grid.add_normal(place, Vector3f::UnitX(), 1.0F);
  grid.add_normal(place, Vector3f(1.0F, 1.0F, 0.0F).normalized(), 1.0F);
  EXPECT_NEAR(std::atan2(grid.voxels()[place].normal.y(), grid.voxels()[place].normal.x()),
              std::atan(1.0F) / 2.0F, 1e-6F);
  // Voxels with the two sides of a thin board have opposite normals, of which neither is right.
  grid.add_normal(place, -grid.voxels()[place].normal, 2.0F);
  EXPECT_FALSE(grid.voxels()[place].has_plane());
}

}  // namespace voxel_grid_test
}  // namespace nodmap::slam6d
