// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/occupancy_map.hpp"

#include <gtest/gtest.h>
#include <octomap/octomap.h>

#include <cmath>
#include <memory>
#include <random>
#include <set>
#include <sstream>

namespace nodmap::slam6d {
namespace occupancy_map_test {

using geometry::SE3;

// A wall at x = 3.025 m, the middle of a voxel of 5 cm; it is 2 m wide and 1 m high. The sensor
// moves sideways by 1 cm from each of the 50 lines to the next.
SweepCloud wall_cloud(double noise_m) {
  std::mt19937 random(46);
  std::normal_distribution<double> noise(0.0, noise_m > 0.0 ? noise_m : 1.0);
  SweepCloud cloud;
  for (int line = 0; line < 50; ++line) {
    for (int i = 0; i < 100; ++i) {
      const double x = 3.025 + (noise_m > 0.0 ? noise(random) : 0.0);
      cloud.points.emplace_back(
          Eigen::Vector3d(x, -0.99 + 0.02 * i, 0.01 + 0.02 * line).cast<float>());
    }
    cloud.lines.push_back(
        {Eigen::Vector3f(0.0F, 0.01F * static_cast<float>(line), 0.5F), cloud.points.size()});
  }
  return cloud;
}

std::unique_ptr<octomap::OcTree> read_bt(const OccupancyMap& map) {
  std::istringstream bytes(map.encode(OccupancyMap::Format::kBt).value());
  auto tree = std::make_unique<octomap::OcTree>(1.0);
  EXPECT_TRUE(tree->readBinary(bytes));
  return tree;
}

// R46: OctoMap can read the file, and its occupied voxels are those of the wall. As the points have
// no noise, they are all of them and no others.
TEST(OccupancyMap, R46_TheOccupiedVoxelsOfTheFileAreThoseOfTheWall) {
  OccupancyMap map({});
  map.insert(wall_cloud(0.0), SE3::Identity());
  const auto tree = read_bt(map);
  EXPECT_DOUBLE_EQ(tree->getResolution(), 0.05);
  std::set<std::pair<int, int>> found;
  for (auto leaf = tree->begin_leafs(); leaf != tree->end_leafs(); ++leaf) {
    if (tree->isNodeOccupied(*leaf)) {
      EXPECT_NEAR(leaf.getX(), 3.025, 1e-6);
      found.insert({static_cast<int>(std::floor(leaf.getY() / 0.05)),
                    static_cast<int>(std::floor(leaf.getZ() / 0.05))});
    }
  }
  EXPECT_EQ(found.size(), 40U * 20U);  // 2 m x 1 m
  // Space is free half way to the wall, and unknown behind it.
  ASSERT_NE(tree->search(1.5, 0.0, 0.5), nullptr);
  EXPECT_FALSE(tree->isNodeOccupied(tree->search(1.5, 0.0, 0.5)));
  EXPECT_EQ(tree->search(3.5, 0.0, 0.5), nullptr);
}

// With 1 cm of noise 1.2 % of the points (those beyond 2.5 sigma) are in the voxels in front of the
// wall and behind it.
TEST(OccupancyMap, R46_PrecisionAndRecallAreHighDespiteRangeNoise) {
  OccupancyMap map({});
  map.insert(wall_cloud(0.01), SE3::Identity());
  const auto tree = read_bt(map);
  int on_wall = 0;
  int off_wall = 0;
  for (auto leaf = tree->begin_leafs(); leaf != tree->end_leafs(); ++leaf) {
    if (tree->isNodeOccupied(*leaf)) {
      (std::abs(leaf.getX() - 3.025) < 0.01 ? on_wall : off_wall) += 1;
    }
  }
  EXPECT_GE(on_wall, 0.99 * 800);                   // recall
  EXPECT_GE(on_wall, 0.90 * (on_wall + off_wall));  // precision: 5000 x 1.2 % = 60 of 860
}

// The oracle: inserts a cloud with OctoMap's own functions, which collect sets of keys, prefer hits
// to misses and update one voxel at a time.
void insert_stock(octomap::OcTree& tree, const SweepCloud& cloud, const SE3& T_map_base,
                  const TraceParams& params) {
  const auto to_octomap = [](const Eigen::Vector3d& p) {
    return octomap::point3d(static_cast<float>(p.x()), static_cast<float>(p.y()),
                            static_cast<float>(p.z()));
  };
  octomap::KeySet free;
  octomap::KeySet occupied;
  std::size_t i = 0;
  for (const SweepCloud::Line& line : cloud.lines) {
    octomap::Pointcloud points;
    for (; i < line.end; ++i) {
      points.push_back(to_octomap(T_map_base * cloud.points[i].cast<double>()));
    }
    const auto origin = to_octomap(T_map_base * line.p_base_mirror.cast<double>());
    if (params.discretize) {
      tree.computeDiscreteUpdate(points, origin, free, occupied, params.max_range_m);
    } else {
      tree.computeUpdate(points, origin, free, occupied, params.max_range_m);
    }
  }
  for (const octomap::OcTreeKey& key : free) {
    if (occupied.count(key) == 0) {
      tree.updateNode(key, false);
    }
  }
  for (const octomap::OcTreeKey& key : occupied) {
    tree.updateNode(key, true);
  }
}

// A wide cluster of points around the sensor, some of them beyond the maximum range.
SweepCloud random_cloud(std::size_t num_lines, std::mt19937& random) {
  std::normal_distribution<float> coordinate(0.0F, 1.5F);
  SweepCloud cloud;
  for (std::size_t line = 0; line < num_lines; ++line) {
    for (int i = 0; i < 700; ++i) {
      cloud.points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
    }
    const Eigen::Vector3f origin(0.125F + 0.01F * static_cast<float>(line), 0.0625F, 0.5F);
    cloud.lines.push_back({origin, cloud.points.size()});
  }
  return cloud;
}

void expect_same_bytes(const OccupancyMap& map, const octomap::OcTree& stock) {
  std::ostringstream bytes;
  ASSERT_TRUE(stock.write(bytes));
  EXPECT_TRUE(map.encode(OccupancyMap::Format::kOt) == bytes.str());  // no 1 MB in the output
  std::ostringstream binary_bytes;
  ASSERT_TRUE(stock.writeBinaryConst(binary_bytes));
  EXPECT_TRUE(map.encode(OccupancyMap::Format::kBt) == binary_bytes.str());
  EXPECT_EQ(map.num_nodes(), stock.size());
}

// Compared byte by byte with OctoMap's own insertion. Clouds from different poses overlap, so that
// a voxel gets both hits and misses. There are enough of them for values to reach OctoMap's limits
// (after five hits or five misses), and for free space to be pruned and expanded again.
TEST(OccupancyMap, R46_InsertionEqualsThatOfOctomap) {
  for (const bool discretize : {false, true}) {
    const TraceParams params{.max_range_m = 3.0, .discretize = discretize};
    std::mt19937 random(47);
    OccupancyMap map(params);
    octomap::OcTree stock(params.resolution_m);
    for (int place = 0; place < 3; ++place) {
      SE3 T_map_base = SE3::Identity();
      T_map_base.translation() = Eigen::Vector3d(0.7 * place, -0.4 * place, 0.1);
      T_map_base.linear() =
          Eigen::AngleAxisd(0.3 * place, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      // If discretized, the cloud has a single line, because OctoMap leaves out duplicates within
      // each call, and we within each cloud.
      const SweepCloud cloud = random_cloud(discretize ? 1 : 3, random);
      for (int times = 0; times < 6; ++times) {
        map.insert(cloud, T_map_base);
        insert_stock(stock, cloud, T_map_base, params);
      }
      expect_same_bytes(map, stock);
    }
    EXPECT_GT(stock.size(), 50'000U);
  }
}

// The same comparison with so many beams that whole blocks of voxels are free.
TEST(OccupancyMap, R46_InsertionEqualsThatOfOctomapWithManyBeams) {
  const TraceParams params{.resolution_m = 0.2};
  OccupancyMap map(params);
  octomap::OcTree stock(params.resolution_m);
  for (int times = 0; times < 3; ++times) {
    map.insert(wall_cloud(0.01), SE3::Identity());
    insert_stock(stock, wall_cloud(0.01), SE3::Identity(), params);
    std::mt19937 random(49);
    const SweepCloud cloud = random_cloud(10, random);
    map.insert(cloud, SE3::Identity());
    insert_stock(stock, cloud, SE3::Identity(), params);
    expect_same_bytes(map, stock);
  }
}

// A beam that is cut off at the maximum range ends in a voxel that another beam hits. The hit
// counts whichever of them comes first.
TEST(OccupancyMap, AHitCountsInAVoxelWhereAnotherBeamIsCutOff) {
  SweepCloud cloud;
  cloud.points = {{3.0F, 0.0F, 0.02F}, {1.99F, 0.0F, 0.02F}, {3.0F, 0.0F, 0.02F}};
  cloud.lines.push_back({Eigen::Vector3f(0.0F, 0.0F, 0.02F), 3});
  OccupancyMap map({.max_range_m = 1.995});
  map.insert(cloud, SE3::Identity());
  const auto tree = read_bt(map);
  ASSERT_NE(tree->search(1.99, 0.0, 0.02), nullptr);
  EXPECT_TRUE(tree->isNodeOccupied(tree->search(1.99, 0.0, 0.02)));
}

TEST(OccupancyMap, BeamsBeyondTheMaximumRangeOnlyFreeSpace) {
  OccupancyMap map({.max_range_m = 2.0});
  map.insert(wall_cloud(0.0), SE3::Identity());
  const auto tree = read_bt(map);
  for (auto leaf = tree->begin_leafs(); leaf != tree->end_leafs(); ++leaf) {
    EXPECT_FALSE(tree->isNodeOccupied(*leaf));
    EXPECT_LT(leaf.getX(), 2.1);
  }
  EXPECT_GT(tree->getNumLeafNodes(), 0U);
}

// A person stands in front of a wall. Points that are known to have moved only free the space
// before them.
TEST(OccupancyMap, MovedPointsOccupyNoVoxel) {
  SweepCloud cloud;
  cloud.points = {{1.02F, 0.0F, 0.02F}, {2.02F, 0.5F, 0.02F}};
  cloud.lines.push_back({Eigen::Vector3f(0.0F, 0.0F, 0.02F), 2});
  OccupancyMap map({});
  map.insert(cloud, SE3::Identity(), {true, false});
  const auto tree = read_bt(map);
  EXPECT_EQ(tree->search(1.02, 0.0, 0.02), nullptr);
  ASSERT_NE(tree->search(0.9, 0.0, 0.02), nullptr);
  EXPECT_FALSE(tree->isNodeOccupied(tree->search(0.9, 0.0, 0.02)));
  ASSERT_NE(tree->search(2.02, 0.5, 0.02), nullptr);
  EXPECT_TRUE(tree->isNodeOccupied(tree->search(2.02, 0.5, 0.02)));
}

TEST(OccupancyMap, EmptyAndTooDistantCloudsAddNothing) {
  OccupancyMap map({});
  map.insert({}, SE3::Identity());
  EXPECT_EQ(map.num_nodes(), 0U);
  EXPECT_TRUE(map.encode(OccupancyMap::Format::kBt).has_value());
  SE3 beyond = SE3::Identity();
  beyond.translation().x() = 1e7;  // OctoMap's tree ends at 1638 m if voxels have 5 cm
  map.insert(wall_cloud(0.0), beyond);
  beyond.translation().x() = 1e300;
  map.insert(wall_cloud(0.0), beyond);
  EXPECT_EQ(map.num_nodes(), 0U);
}

}  // namespace occupancy_map_test
}  // namespace nodmap::slam6d
