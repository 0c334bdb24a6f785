// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/cloud_voxels.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace nodmap::slam6d {
namespace cloud_voxels_test {

struct Marks {
  bool free = false;
  bool occupied = false;
  bool operator==(const Marks&) const = default;
};
using MarksByVoxel = std::map<VoxelCode, Marks>;

// The oracle: computes the code by its definition, bit by bit.
VoxelCode interleave(const VoxelKey& key) {
  VoxelCode code = 0;
  for (unsigned bit = 0; bit < kOctreeLevels; ++bit) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      code |= VoxelCode{key[axis]} >> bit << (3U * bit + axis) & VoxelCode{1} << (3U * bit + axis);
    }
  }
  return code;
}

MarksByVoxel list(const CloudVoxels& voxels) {
  constexpr std::size_t kVoxelsPerCube = CloudVoxels::kWords * CloudVoxels::kBitsPerWord;
  MarksByVoxel marked;
  for (const auto& cube : voxels.cubes()) {
    for (std::size_t i = 0; i < kVoxelsPerCube; ++i) {
      const auto is_set = [&](const CloudVoxels::Bits& bits) {
        return (bits[i / CloudVoxels::kBitsPerWord] >> i % CloudVoxels::kBitsPerWord & 1U) != 0U;
      };
      const Marks marks{is_set(cube->free), is_set(cube->occupied)};
      if (marks.free || marks.occupied) {
        marked[cube->code * kVoxelsPerCube + i] = marks;
      }
    }
  }
  return marked;
}

TEST(VoxelCode, IsTheInterleavedKey) {
  std::mt19937 random(60);
  std::uniform_int_distribution<unsigned> coordinate(0, 0xFFFF);
  for (int i = 0; i < 1000; ++i) {
    const VoxelKey key{static_cast<std::uint16_t>(coordinate(random)),
                       static_cast<std::uint16_t>(coordinate(random)),
                       static_cast<std::uint16_t>(coordinate(random))};
    ASSERT_EQ(code_of(key), interleave(key));
  }
}

// Compared with a std::map of single voxels. Some voxels are so near that they share cubes, some so
// far apart that their cubes compete for a slot of the table, and there are more cubes than the
// first table has room for.
TEST(CloudVoxels, EqualsAMapOfSingleVoxels) {
  std::mt19937 random(48);
  CloudVoxels voxels;
  for (const unsigned reach : {20U, 200U, 2000U, 0xFFFFU}) {
    voxels.clear();
    std::uniform_int_distribution<unsigned> coordinate(0, reach);
    std::bernoulli_distribution hit(0.3);
    MarksByVoxel expected;
    for (int i = 0; i < 5000; ++i) {
      const VoxelCode voxel = code_of({static_cast<std::uint16_t>(coordinate(random)),
                                       static_cast<std::uint16_t>(coordinate(random)),
                                       static_cast<std::uint16_t>(coordinate(random))});
      Marks& marks = expected[voxel];
      if (hit(random)) {
        EXPECT_EQ(voxels.mark_occupied(voxel), !marks.occupied);
        marks.occupied = true;
      } else {
        voxels.mark_free(voxel);
        marks.free = true;
      }
    }
    EXPECT_TRUE(list(voxels) == expected) << reach;
  }
}

TEST(CloudVoxels, ClearingRemovesAllVoxelsAndKeepsTheMemory) {
  CloudVoxels voxels;
  EXPECT_TRUE(voxels.cubes().empty());
  voxels.mark_free(123);
  EXPECT_TRUE(voxels.mark_occupied(456));
  const std::size_t memory_bytes = voxels.memory_bytes();
  voxels.clear();
  EXPECT_TRUE(voxels.cubes().empty());
  EXPECT_TRUE(voxels.mark_occupied(456));
  EXPECT_EQ(list(voxels).size(), 1U);
  EXPECT_EQ(voxels.memory_bytes(), memory_bytes);
}

}  // namespace cloud_voxels_test
}  // namespace nodmap::slam6d
