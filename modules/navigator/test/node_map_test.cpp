// SPDX-License-Identifier: BSD-3-Clause
// Which tiles of MAP_2D the node takes, and that it plans on them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "modules/navigator/test/navigator_node.hpp"
#include "nodmap/grid_chunk_t.hpp"
#include "nodmap/path_t.hpp"

namespace nodmap::navigator {
namespace node_map_test {

constexpr bus::Sender kSlam{0x7F000001, 40'001};
constexpr bus::Sender kOther{0x7F000001, 40'002};

// A navigator whose goal is 6 m ahead, and a map with a wall 3.5 m ahead, from 4 m on the right to
// 2 m on the left.
class NavigatorNodeMap : public test::NavigatorNodeScans {
 protected:
  void give_pose(const bus::Sender& sender = kSlam, const geometry::SE2& T_map_odom = {}) {
    bus_.deliver_from(
        sender, "POSE_2D",
        node::write_corrected_pose(time::from_utime(now_us_),
                                   geometry::to_se3(T_map_odom * geometry::SE2{x_, 0.0, 0.0}),
                                   geometry::to_se3(T_map_odom)));
  }

  void give_goal() {
    nodmap::goal_t goal{};
    goal.utime = now_us_;
    goal.is_active = 1;
    goal.position_m[0] = 6.0;
    goal.tolerance_m = 0.2;
    bus_.deliver("GOAL", goal);
  }

  [[nodiscard]] static nodmap::grid_chunk_t tile(std::int64_t revision) {
    nodmap::grid_chunk_t tile{};
    tile.map_revision = revision;
    tile.num_chunks = 1;
    tile.cell_size_m = 0.05;
    tile.origin_x_m = 0.0;
    tile.origin_y_m = -4.0;
    tile.grid_width = tile.tile_width = 160;
    tile.grid_height = tile.tile_height = 160;
    tile.cells.assign(160U * 160U, 0);
    for (std::size_t row = 0; row < 120; ++row) {
      std::fill_n(tile.cells.begin() + static_cast<std::ptrdiff_t>(160 * row + 70), 4, 100);
    }
    tile.num_cells = static_cast<std::int32_t>(tile.cells.size());
    return tile;
  }

  // How far left the planned path leads, metres. The robot is set back to its start.
  double leftmost_m() {
    for (int i = 0; i < 200; ++i) {
      tick_with_scan();
    }
    const auto path = bus_.last<nodmap::path_t>("PATH");
    EXPECT_EQ(path.state, nodmap::path_t::PLANNED);
    return path.y_m.empty() ? 0.0 : *std::ranges::max_element(path.y_m);
  }
};

TEST_F(NavigatorNodeMap, ThePlanLeadsAroundAWallOfTheMap) {
  give_pose();
  give_goal();
  EXPECT_LT(leftmost_m(), 0.5);
  bus_.deliver_from(kSlam, "MAP_2D", tile(7));
  EXPECT_GT(leftmost_m(), 2.0);
  // A later revision shows that the wall is gone.
  nodmap::grid_chunk_t without_wall = tile(8);
  std::ranges::fill(without_wall.cells, std::int8_t{0});
  bus_.deliver_from(kSlam, "MAP_2D", without_wall);
  EXPECT_LT(leftmost_m(), 0.5);
}

// The map is in the frame of the pose.
TEST_F(NavigatorNodeMap, OnlyTheMapOfTheProcessThatSendsThePosesIsUsed) {
  bus_.deliver_from(kSlam, "MAP_2D", tile(1));
  give_pose();
  bus_.deliver_from(kOther, "MAP_2D", tile(1));
  EXPECT_EQ(rejected("map_tile_without_pose"), 2);
  give_goal();
  EXPECT_LT(leftmost_m(), 0.5);
  bus_.deliver_from(kSlam, "MAP_2D", tile(1));
  EXPECT_GT(leftmost_m(), 2.0);
  // 2D SLAM is restarted: its map is another one, and the goal in the old one is void.
  give_pose(kOther);
  give_goal();
  EXPECT_LT(leftmost_m(), 0.5);
}

// A wall is ahead of the robot. In another map, which is a quarter turn off, the goal is to the
// robot's right, where the wall was in the former map.
class NavigatorNodeMapOfAnotherFrame : public NavigatorNodeMap {
 protected:
  static constexpr geometry::SE2 kQuarterTurn{0.0, 0.0, 0.5 * geometry::kPi};

  // The wall alone might be a ramp; with floor seen right before it, it is none.
  void see_wall() {
    const test::Ground ground{{{{2.5, -4.0}, {2.6, 4.0}, 1.0}}};
    const auto wall = test::scan_of(ground, {}, 0.0);
    const auto floor = test::scan_of(ground, {}, geometry::deg_to_rad(-12.0));
    for (int i = 0; i < 75; ++i) {
      tick_with(wall);
      tick_with(floor);
    }
  }

  // How far ahead or back the path leads, metres.
  double farthest_ahead_m() {
    see_wall();
    const auto path = bus_.last<nodmap::path_t>("PATH");
    EXPECT_EQ(path.state, nodmap::path_t::PLANNED);
    EXPECT_FALSE(path.x_m.empty());
    double farthest_m = 0.0;
    for (const double x_m : path.x_m) {
      farthest_m = std::max(farthest_m, std::abs(x_m));
    }
    return farthest_m;
  }
};

TEST_F(NavigatorNodeMapOfAnotherFrame, GroundKnownBefore2dSlamWasRestartedIsForgotten) {
  give_pose();
  give_goal();
  EXPECT_GT(farthest_ahead_m(), 2.0) << "the goal is behind the wall";
  give_pose(kOther, kQuarterTurn);
  give_goal();
  EXPECT_LT(farthest_ahead_m(), 0.5);
}

TEST_F(NavigatorNodeMapOfAnotherFrame, GroundKnownBeforeTheRobotWasFoundInASavedMapIsForgotten) {
  give_goal();
  EXPECT_GT(farthest_ahead_m(), 2.0);
  give_pose(kSlam, kQuarterTurn);
  EXPECT_LT(farthest_ahead_m(), 0.5);
}

// In a recording all senders are one; there the number of the revision tells.
TEST_F(NavigatorNodeMap, TheSecondTileOfALowerRevisionBeginsANewMap) {
  give_pose();
  give_goal();
  bus_.deliver_from(kSlam, "MAP_2D", tile(7));
  nodmap::grid_chunk_t elsewhere = tile(3);
  elsewhere.origin_y_m = 50.0;
  bus_.deliver_from(kSlam, "MAP_2D", elsewhere);
  EXPECT_EQ(rejected("map_tile_of_older_revision"), 1);
  EXPECT_GT(leftmost_m(), 2.0);
  bus_.deliver_from(kSlam, "MAP_2D", elsewhere);
  EXPECT_EQ(rejected("map_tile_of_older_revision"), 1);
  EXPECT_LT(leftmost_m(), 0.5);
}

TEST_F(NavigatorNodeMap, CorruptTilesAreCountedAndChangeNothing) {
  give_pose();
  give_goal();
  nodmap::grid_chunk_t corrupt = tile(1);
  corrupt.origin_x_m = std::numeric_limits<double>::quiet_NaN();
  bus_.deliver_from(kSlam, "MAP_2D", corrupt);
  corrupt = tile(1);
  corrupt.tile_width = 500'000'000;
  bus_.deliver_from(kSlam, "MAP_2D", corrupt);
  corrupt = tile(1);
  corrupt.tile_height = -1;
  bus_.deliver_from(kSlam, "MAP_2D", corrupt);
  EXPECT_EQ(rejected("implausible_map_tile"), 3);
  corrupt = tile(1);
  corrupt.cell_size_m = 5.0;
  bus_.deliver_from(kSlam, "MAP_2D", corrupt);
  EXPECT_EQ(rejected("map_tile_of_unusable_size"), 1);
  EXPECT_LT(leftmost_m(), 0.5);
}

}  // namespace node_map_test
}  // namespace nodmap::navigator
