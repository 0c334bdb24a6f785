// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/map_2d_input.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>

#include "nodmap/pose_t.hpp"
#include "tests/support/memory_bus.hpp"

namespace nodmap::node {
namespace map_2d_input_test {

constexpr bus::Sender kSlam{0x7F000001, 40'001};
constexpr bus::Sender kOther{0x7F000001, 40'002};

class Map2dInputTest : public ::testing::Test {
 protected:
  Map2dInputTest() {
    bus_.subscribe<nodmap::pose_t>("POSE_2D",
                                   [this](const auto&) { is_other_ = input_.follow_pose(); });
    bus_.subscribe<nodmap::grid_chunk_t>("MAP_2D", [this](const auto& m) {
      const auto tile = input_.read(m);
      begins_map_ = tile ? std::optional(tile->begins_map) : std::nullopt;
    });
  }

  // Whether the sender is another one than that of the pose before.
  bool give_pose(const bus::Sender& sender) {
    bus_.deliver_from(sender, "POSE_2D", nodmap::pose_t{});
    return is_other_;
  }
  // Whether the tile begins a map; empty if it is rejected.
  std::optional<bool> give_tile(const bus::Sender& sender, std::int64_t revision) {
    nodmap::grid_chunk_t message{};
    message.map_revision = revision;
    message.cell_size_m = 0.1;
    message.grid_width = message.grid_height = 1;
    message.tile_width = message.tile_height = 1;
    message.num_cells = 1;
    message.cells = {0};
    bus_.deliver_from(sender, "MAP_2D", message);
    return begins_map_;
  }
  std::int64_t rejected(const char* cause) const {
    const auto found = counts_.rejected().find(cause);
    return found == counts_.rejected().end() ? 0 : found->second;
  }

  ::nodmap::test::MemoryBus bus_;
  MessageCounts counts_;
  Map2dInput input_{counts_, bus_};
  bool is_other_ = false;
  std::optional<bool> begins_map_;
};

TEST_F(Map2dInputTest, TilesComeOnlyFromTheSenderOfThePoses) {
  EXPECT_FALSE(give_tile(kSlam, 0)) << "there was no pose yet";
  EXPECT_FALSE(give_pose(kSlam));
  EXPECT_EQ(give_tile(kSlam, 0), false);
  EXPECT_FALSE(give_tile(kOther, 0));
  EXPECT_EQ(rejected("map_tile_without_pose"), 2);
}

// It counts its revisions from the start again, and none of them is late.
TEST_F(Map2dInputTest, PosesOfAnotherProcessBeginAnotherMap) {
  (void)give_pose(kSlam);
  EXPECT_EQ(give_tile(kSlam, 7), false);
  EXPECT_TRUE(give_pose(kOther));
  EXPECT_FALSE(give_pose(kOther));
  EXPECT_EQ(give_tile(kOther, 0), false);
  EXPECT_EQ(rejected("map_tile_of_older_revision"), 0);
}

TEST_F(Map2dInputTest, TheSecondTileOfAnOlderRevisionBeginsAnotherMap) {
  (void)give_pose(kSlam);
  EXPECT_EQ(give_tile(kSlam, 7), false);
  EXPECT_FALSE(give_tile(kSlam, 0));
  EXPECT_EQ(rejected("map_tile_of_older_revision"), 1);
  EXPECT_EQ(give_tile(kSlam, 0), true);
}

// Otherwise anybody's tiles would begin another map.
TEST_F(Map2dInputTest, ARejectedTileDoesNotCountAsOfAnOlderRevision) {
  (void)give_pose(kSlam);
  EXPECT_EQ(give_tile(kSlam, 7), false);
  EXPECT_FALSE(give_tile(kOther, 0));
  EXPECT_FALSE(give_tile(kSlam, 0));
  EXPECT_EQ(give_tile(kSlam, 7), false);
}

TEST_F(Map2dInputTest, ImplausibleTilesAreRejected) {
  (void)give_pose(kSlam);
  bus_.deliver_from(kSlam, "MAP_2D", nodmap::grid_chunk_t{});
  EXPECT_FALSE(begins_map_);
  EXPECT_EQ(rejected("implausible_map_tile"), 1);
}

}  // namespace map_2d_input_test
}  // namespace nodmap::node
