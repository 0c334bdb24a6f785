// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/point_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace nodmap::slam6d {
namespace {

std::vector<Eigen::Vector3d> random_points(std::mt19937& random, std::size_t count) {
  std::uniform_real_distribution<double> coordinate(-5.0, 5.0);
  std::vector<Eigen::Vector3d> points(count);
  for (Eigen::Vector3d& p : points) {
    p = {coordinate(random), coordinate(random), coordinate(random)};
  }
  return points;
}

// Against sorting all distances, while batches of every size are added and trees merge.
TEST(PointIndex, EqualsBruteForceOverManyBatches) {
  std::mt19937 random(1);
  std::vector<Eigen::Vector3d> all;
  PointIndex index;
  for (const std::size_t batch : {500U, 3U, 1U, 40U, 300U, 2U, 700U}) {
    const auto points = random_points(random, batch);
    index.add(points);
    all.insert(all.end(), points.begin(), points.end());
    for (const Eigen::Vector3d& query : random_points(random, 50)) {
      std::vector<std::pair<double, std::size_t>> expected;
      for (std::size_t i = 0; i < all.size(); ++i) {
        expected.emplace_back((all[i] - query).squaredNorm(), i);
      }
      std::sort(expected.begin(), expected.end());
      const auto found = index.nearest_k(query, 16);
      ASSERT_EQ(found.size(), 16U);
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].index, expected[i].second);
        EXPECT_DOUBLE_EQ(found[i].sq_distance_m2, expected[i].first);
      }
      const auto nearest = index.nearest(query, 0.6);
      ASSERT_EQ(nearest.has_value(), expected[0].first < 0.36);
      if (nearest) {
        EXPECT_EQ(nearest->index, expected[0].second);
      }
    }
  }
  EXPECT_EQ(index.points().size(), all.size());
}

TEST(PointIndex, EmptyAndFewerThanAsked) {
  PointIndex index;
  EXPECT_FALSE(index.nearest(Eigen::Vector3d::Zero(), 1.0));
  EXPECT_TRUE(index.nearest_k(Eigen::Vector3d::Zero(), 3).empty());
  index.add({});
  EXPECT_FALSE(index.nearest(Eigen::Vector3d::Zero(), 1.0));
  const std::vector<Eigen::Vector3d> one{{1.0, 0.0, 0.0}};
  index.add(one);
  EXPECT_FALSE(index.nearest(Eigen::Vector3d::Zero(), 0.99));
  EXPECT_TRUE(index.nearest(Eigen::Vector3d::Zero(), 1.01));
  EXPECT_EQ(index.nearest_k(Eigen::Vector3d::Zero(), 3).size(), 1U);
  EXPECT_TRUE(index.nearest_k(Eigen::Vector3d::Zero(), 0).empty());
}

TEST(PointIndex, SurvivesBeingMoved) {
  PointIndex index;
  const std::vector<Eigen::Vector3d> points{{1, 0, 0}, {2, 0, 0}};
  index.add(points);
  const PointIndex moved = std::move(index);
  const auto found = moved.nearest({1.9, 0, 0}, 1.0);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->index, 1U);
}

}  // namespace
}  // namespace nodmap::slam6d
