// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/log_odds_map.hpp"

#include <gtest/gtest.h>
#include <octomap/octomap.h>

#include <random>
#include <set>
#include <sstream>

#include "modules/slam6d/occupancy/octree_encoder.hpp"

namespace nodmap::slam6d {
namespace log_odds_map_test {

constexpr double kResolutionM = 0.05;
constexpr std::uint16_t kFirst =
    0x8000 - 40;  // keys around 0x8000, so that all eight octants have some

VoxelKey draw_key(unsigned reach, std::mt19937& random) {
  std::uniform_int_distribution<unsigned> offset(0, reach - 1);
  return {static_cast<std::uint16_t>(kFirst + offset(random)),
          static_cast<std::uint16_t>(kFirst + offset(random)),
          static_cast<std::uint16_t>(kFirst + offset(random))};
}

// Applies the same updates to our map and, voxel by voxel, to OctoMap's tree, which is the oracle.
class TwoMaps {
 public:
  void update(unsigned reach, int misses, int hits, std::mt19937& random) {
    std::set<VoxelKey> free;
    std::set<VoxelKey> occupied;
    for (int i = 0; i < misses; ++i) {
      free.insert(draw_key(reach, random));
    }
    for (int i = 0; i < hits; ++i) {
      occupied.insert(draw_key(reach, random));
    }
    update(free, occupied);
  }

  void update(const std::set<VoxelKey>& free, const std::set<VoxelKey>& occupied) {
    cloud_.clear();
    for (const VoxelKey& key : free) {
      cloud_.mark_free(code_of(key));
      if (!occupied.contains(key)) {
        tree_.updateNode(octomap::OcTreeKey(key[0], key[1], key[2]), false);
      }
    }
    for (const VoxelKey& key : occupied) {
      cloud_.mark_occupied(code_of(key));
      tree_.updateNode(octomap::OcTreeKey(key[0], key[1], key[2]), true);
    }
    map_.update(cloud_);
  }

  void expect_the_same() const {
    std::ostringstream ot;
    ASSERT_TRUE(tree_.write(ot));
    EXPECT_TRUE(encode_ot(map_, kResolutionM) == ot.str());
    std::ostringstream bt;
    ASSERT_TRUE(tree_.writeBinaryConst(bt));
    EXPECT_TRUE(encode_bt(map_, kResolutionM) == bt.str());
    EXPECT_EQ(count_nodes(map_), tree_.size());
  }

  [[nodiscard]] const LogOddsMap& map() const { return map_; }

 private:
  CloudVoxels cloud_;
  LogOddsMap map_;
  octomap::OcTree tree_{kResolutionM};
};

std::set<VoxelKey> whole_cube(std::uint16_t edge) {
  std::set<VoxelKey> keys;
  for (std::uint16_t x = 0; x < edge; ++x) {
    for (std::uint16_t y = 0; y < edge; ++y) {
      for (std::uint16_t z = 0; z < edge; ++z) {
        keys.insert({x, y, z});
      }
    }
  }
  return keys;
}

// There are few voxels and many clouds, so that values reach both limits and leave them again.
TEST(LogOddsMap, UpdatesEqualThoseOfOctomap) {
  std::mt19937 random(64);
  TwoMaps maps;
  for (int cloud = 0; cloud < 20; ++cloud) {
    maps.update(80, 5000, 100, random);
    maps.update(9, 500, cloud % 10 < 5 ? 200 : 0, random);
    maps.expect_the_same();
  }
}

// 32 x 32 x 32 voxels become free, then one of them is occupied, then all are free again: leaves
// are merged, split and merged again. While all are equal, the map takes hardly any memory.
TEST(LogOddsMap, EqualVoxelsAreMerged) {
  TwoMaps maps;
  const std::set<VoxelKey> cube = whole_cube(32);
  maps.update(cube, {});
  maps.expect_the_same();
  EXPECT_EQ(count_nodes(maps.map()), 12U);  // from the root down to one leaf
  EXPECT_LT(maps.map().memory_bytes(), 2000U);
  for (int i = 0; i < 6; ++i) {
    maps.update(cube, {});
  }
  maps.update(cube, {{3, 4, 5}});
  maps.expect_the_same();
  EXPECT_GT(count_nodes(maps.map()), 12U);
  for (int i = 0; i < 8; ++i) {
    maps.update(cube, {});
  }
  maps.expect_the_same();
  EXPECT_EQ(count_nodes(maps.map()), 12U);
  EXPECT_LT(maps.map().memory_bytes(), 2000U);
}

TEST(LogOddsMap, AnEmptyMapIsAnEmptyTree) {
  TwoMaps maps;
  maps.expect_the_same();
  EXPECT_EQ(count_nodes(maps.map()), 0U);
}

}  // namespace log_odds_map_test
}  // namespace nodmap::slam6d
