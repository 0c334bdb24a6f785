// SPDX-License-Identifier: BSD-3-Clause
#include "common/formats/octomap_file.hpp"

#include <gtest/gtest.h>
#include <octomap/octomap.h>

#include <algorithm>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <tuple>

namespace nodmap::formats {
namespace octomap_file_test {

using Voxels = std::set<std::tuple<int, int, int>>;

// Keys of the occupied voxels, each leaf cut into its smallest.
Voxels voxels_of(const OccupiedSpace& space) {
  Voxels voxels;
  for (const OccupiedSpace::Cube& cube : space.cubes) {
    const int edge = 1 << cube.level;
    for (int i = 0; i < edge * edge * edge; ++i) {
      voxels.emplace(cube.key[0] + i % edge, cube.key[1] + i / edge % edge,
                     cube.key[2] + i / (edge * edge));
    }
  }
  return voxels;
}

Voxels voxels_of(octomap::OcTree tree) {
  tree.expand();
  Voxels voxels;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (tree.isNodeOccupied(*leaf)) {
      voxels.emplace(leaf.getKey()[0], leaf.getKey()[1], leaf.getKey()[2]);
    }
  }
  return voxels;
}

std::string file_of(octomap::OcTree& tree) {
  std::ostringstream bytes;
  tree.writeBinary(bytes);
  return bytes.str();
}

// Free and occupied voxels around the origin, one block of 4 x 4 x 4 pruned to a single leaf.
octomap::OcTree some_tree() {
  octomap::OcTree tree(0.05);
  std::mt19937 random(3);
  std::uniform_int_distribution<int> near(-40, 40);
  const auto key = [](int x, int y, int z) {
    return octomap::OcTreeKey(static_cast<octomap::key_type>(OccupiedSpace::kOriginKey + x),
                              static_cast<octomap::key_type>(OccupiedSpace::kOriginKey + y),
                              static_cast<octomap::key_type>(OccupiedSpace::kOriginKey + z));
  };
  for (int i = 0; i < 500; ++i) {
    tree.updateNode(key(near(random), near(random), near(random)), i % 2 == 0);
  }
  for (int i = 0; i < 64; ++i) {
    const octomap::OcTreeKey voxel = key(48 + i % 4, 48 + i / 4 % 4, 48 + i / 16);
    for (int again = 0; again < 10; ++again) {  // up to the limit, so that all are alike
      tree.updateNode(voxel, true);
    }
  }
  tree.prune();
  return tree;
}

// The oracle is OctoMap itself.
TEST(OctomapFile, HasTheVoxelsThatOctomapWrote) {
  octomap::OcTree tree = some_tree();
  const auto space = read_octomap(file_of(tree));
  ASSERT_TRUE(space);
  EXPECT_DOUBLE_EQ(space->voxel_m, 0.05);
  EXPECT_EQ(voxels_of(*space), voxels_of(tree));
  EXPECT_TRUE(std::ranges::any_of(space->cubes, [](const auto& cube) { return cube.level == 2; }));
}

TEST(OctomapFile, AnEmptyTreeHasNone) {
  octomap::OcTree tree(0.1);
  const auto space = read_octomap(file_of(tree));
  ASSERT_TRUE(space);
  EXPECT_TRUE(space->cubes.empty());
}

TEST(OctomapFile, TruncatedAnywhereItIsRefused) {
  octomap::OcTree tree = some_tree();
  const std::string file = file_of(tree);
  const std::size_t head = file.find("data\n") + 5;
  for (std::size_t size = 0; size < file.size(); ++size) {
    const bool is_head = size == head || size == head - 1;  // with or without its newline
    EXPECT_EQ(read_octomap(file.substr(0, size)).has_value(), is_head) << size;
  }
  EXPECT_FALSE(read_octomap(file + '\0'));
}

TEST(OctomapFile, NonsenseIsRefused) {
  const std::string head = "# Octomap OcTree binary file\nid OcTree\nsize 1\n";
  EXPECT_TRUE(read_octomap(head + "res 0.1\ndata\n"));
  for (const char* rest : {"data\n", "res 0\ndata\n", "res -1\ndata\n", "res nan\ndata\n",
                           "res 1e9\ndata\n", "res x\ndata\n", "res 0.1\n"}) {
    EXPECT_FALSE(read_octomap(head + rest)) << rest;
  }
  EXPECT_FALSE(read_octomap("# Octomap OcTree file\nres 0.1\ndata\n"));
  // Inner nodes for ever: deeper than any tree.
  EXPECT_FALSE(read_octomap(head + "res 0.1\ndata\n" + std::string(100'000, '\xFF')));
}

}  // namespace octomap_file_test
}  // namespace nodmap::formats
