// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/voxel_blocks.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace nodmap::slam6d {
namespace {

using Key = VoxelBlocks::Key;

// Interleaved bit by bit, as the definition says.
std::uint64_t morton(const Key& key) {
  std::uint64_t code = 0;
  for (unsigned bit = 0; bit < 16; ++bit) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      code |= std::uint64_t{key[axis] >> bit & 1U} << (3U * bit + axis);
    }
  }
  return code;
}

// Every marked voxel of the blocks, by its Morton code; true is occupied.
std::vector<std::pair<std::uint64_t, bool>> list(VoxelBlocks& voxels) {
  std::vector<std::pair<std::uint64_t, bool>> marked;
  for (const VoxelBlocks::Block& block : voxels.sorted()) {
    for (std::uint64_t bit = 0; bit < 512; ++bit) {
      for (const bool occupied : {false, true}) {
        const auto& bits = occupied ? block.occupied : block.free;
        if ((bits[bit / 64U] >> bit % 64U & 1U) != 0U) {
          marked.emplace_back(block.code * 512U + bit, occupied);
        }
      }
    }
  }
  return marked;
}

// Against a sorted map of single voxels: near ones that share blocks, and ones all over space, more
// than the first table of blocks has room for.
TEST(VoxelBlocks, EqualsAMapOfSingleVoxelsInMortonOrder) {
  std::mt19937 random(48);
  VoxelBlocks voxels;
  for (const int reach : {20, 200, 65535}) {
    voxels.clear();
    std::uniform_int_distribution<int> coordinate(0, reach);
    std::bernoulli_distribution hit(0.3);
    std::map<std::uint64_t, bool> expected;
    for (int i = 0; i < 20'000; ++i) {
      const Key key{static_cast<std::uint16_t>(coordinate(random)),
                    static_cast<std::uint16_t>(coordinate(random)),
                    static_cast<std::uint16_t>(coordinate(random))};
      bool& occupied = expected[morton(key)];
      if (hit(random)) {
        EXPECT_EQ(voxels.add_occupied(key), !occupied);
        occupied = true;
      } else {
        voxels.add_free(key);
      }
    }
    const std::vector<std::pair<std::uint64_t, bool>> in_order(expected.begin(), expected.end());
    EXPECT_TRUE(list(voxels) == in_order) << reach;
  }
}

TEST(VoxelBlocks, ClearedHoldsNothing) {
  VoxelBlocks voxels;
  EXPECT_TRUE(voxels.sorted().empty());
  voxels.add_free({1, 2, 3});
  voxels.clear();
  EXPECT_TRUE(voxels.sorted().empty());
  EXPECT_TRUE(voxels.add_occupied({1, 2, 3}));
  EXPECT_EQ(list(voxels).size(), 1U);
}

}  // namespace
}  // namespace nodmap::slam6d
