// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/node.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/node/messages.hpp"
#include "modules/explorer/test/grid_world.hpp"
#include "tests/support/memory_bus.hpp"

namespace nodmap::explorer {
namespace node_test {

class ExplorerNodeTest : public ::testing::Test {
 protected:
  ExplorerNodeTest() : world_({-4.0, -4.0}, {8.0, 4.0}), node_(context_, {}) {
    world_.add_wall({-0.5, -1.0}, {5.0, -1.0});
    world_.add_wall({-0.5, 1.0}, {5.0, 1.0});
    world_.scan({0.0, 0.0, 0.0});
  }

  void give_map(std::int64_t revision = 0) {
    const MapTile tile = world_.map();
    nodmap::grid_chunk_t message{};
    message.map_revision = revision;
    message.num_chunks = 1;
    message.cell_size_m = tile.cell_size_m;
    message.origin_x_m = tile.cell_size_m * tile.first.x();
    message.origin_y_m = tile.cell_size_m * tile.first.y();
    message.grid_width = message.tile_width = tile.width;
    message.grid_height = message.tile_height = tile.height;
    message.num_cells = static_cast<std::int32_t>(tile.cells.size());
    message.cells.assign(tile.cells.begin(), tile.cells.end());
    bus_.deliver("MAP_2D", message);
  }
  // Lets half a second pass and delivers a pose.
  nodmap::exploration_t give_pose(std::int8_t state = nodmap::pose_t::TRACKING) {
    utime_us_ += 500'000;
    nodmap::pose_t pose = node::write_corrected_pose(
        time::from_utime(utime_us_), geometry::SE3::Identity(), geometry::SE3::Identity());
    pose.state = state;
    bus_.deliver("POSE_2D", pose);
    give_odometry(0.0);
    return bus_.last<nodmap::exploration_t>("EXPLORATION");
  }
  void give_odometry(double x_m) {
    nodmap::odometry_t message = node::write_odometry(
        time::from_utime(utime_us_), geometry::SE3(Eigen::Translation3d(x_m, 0.0, 0.0)));
    message.odometry_seq = odometry_seq_++;
    bus_.deliver("ODOMETRY", message);
  }
  void ask(bool is_active) {
    nodmap::explore_t message{};
    message.is_active = static_cast<std::int8_t>(is_active);
    message.requested_by = "somebody";
    bus_.deliver("EXPLORE", message);
  }
  void stop(bool is_stopped) {
    nodmap::stop_t message{};
    message.utime = ++num_stops_;
    message.is_stopped = static_cast<std::int8_t>(is_stopped);
    bus_.deliver("STOP", message);
  }

  test::GridWorld world_;
  ::nodmap::test::MemoryBus bus_;
  node::MessageCounts counts_;
  node::Context context_{bus_, counts_, {}};
  ExplorerNode node_;
  std::int64_t utime_us_ = 0;
  std::int64_t num_stops_ = 0;
  std::int64_t odometry_seq_ = 0;
};

TEST_F(ExplorerNodeTest, SendsNoGoalUntilItIsAskedTo) {
  give_map();
  EXPECT_EQ(give_pose().state, nodmap::exploration_t::IDLE);
  EXPECT_EQ(bus_.count("GOAL"), 0U);
  ask(true);
  const auto exploration = give_pose();
  EXPECT_EQ(exploration.state, nodmap::exploration_t::EXPLORING);
  EXPECT_GT(exploration.num_viewpoints, 0);
  EXPECT_GT(exploration.num_points, 0);
  EXPECT_GT(exploration.num_frontier_points, 0);
  EXPECT_GT(exploration.seen_m2, 5.0);
  ASSERT_EQ(bus_.count("GOAL"), 1U);
  const auto goal = bus_.last<nodmap::goal_t>("GOAL");
  EXPECT_TRUE(goal.is_active);
  EXPECT_GT(std::hypot(goal.position_m[0], goal.position_m[1]), ExplorerParams{}.goal_tolerance_m);
}

TEST_F(ExplorerNodeTest, RepeatsItsGoalOnceASecondAndRecognisesItAsItsOwn) {
  give_map();
  ask(true);
  (void)give_pose();
  for (int i = 0; i < 4; ++i) {
    bus_.deliver("GOAL", bus_.last<nodmap::goal_t>("GOAL"));
    EXPECT_EQ(give_pose().state, nodmap::exploration_t::EXPLORING);
  }
  EXPECT_EQ(bus_.count("GOAL"), 3U);
}

TEST_F(ExplorerNodeTest, YieldsToAGoalOfSomebodyElse) {
  give_map();
  ask(true);
  (void)give_pose();
  auto goal = bus_.last<nodmap::goal_t>("GOAL");
  goal.position_m[0] += 1.0;
  bus_.deliver("GOAL", goal);
  EXPECT_EQ(give_pose().state, nodmap::exploration_t::IDLE);
  EXPECT_EQ(bus_.count("GOAL"), 1U) << "nothing is sent against it";
}

TEST_F(ExplorerNodeTest, AStopMakesItWaitAndThenContinue) {
  give_map();
  ask(true);
  (void)give_pose();
  stop(true);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(give_pose().reason, "The robot is stopped.");
  }
  EXPECT_EQ(bus_.count("GOAL"), 1U);
  stop(false);
  EXPECT_EQ(give_pose().state, nodmap::exploration_t::EXPLORING);
  EXPECT_EQ(bus_.count("GOAL"), 2U);
  EXPECT_EQ(node_.metrics()["failures"], 0);
}

TEST_F(ExplorerNodeTest, EndedByTheUserItLeavesTheRobotWhereItIs) {
  give_map();
  ask(true);
  (void)give_pose();
  ask(false);
  const auto goal = bus_.last<nodmap::goal_t>("GOAL");
  EXPECT_TRUE(goal.is_active);
  EXPECT_EQ(goal.position_m[0], 0.0);
  const auto exploration = give_pose();
  EXPECT_EQ(exploration.state, nodmap::exploration_t::IDLE);
  EXPECT_EQ(exploration.reason, "Ended by somebody.");
}

// It has driven 2 m since the last pose of 2D SLAM, 6 s ago.
TEST_F(ExplorerNodeTest, EndedByTheUserItLeavesTheRobotWhereItIsByTheNewestOdometry) {
  give_map();
  ask(true);
  (void)give_pose();
  utime_us_ += 6'000'000;
  give_odometry(2.0);
  ask(false);
  EXPECT_EQ(bus_.last<nodmap::goal_t>("GOAL").position_m[0], 2.0);
}

TEST_F(ExplorerNodeTest, DecidesNothingWithoutATrustworthyPose) {
  give_map();
  ask(true);
  (void)give_pose();
  const std::size_t num_decisions = bus_.count("EXPLORATION");
  (void)give_pose(nodmap::pose_t::LOST);
  EXPECT_EQ(bus_.count("EXPLORATION"), num_decisions);
  EXPECT_EQ(node_.health().state, node::HealthState::kDegraded);
}

// Poses of 2D SLAM come with level scans: one a second when the robot is slow.
TEST_F(ExplorerNodeTest, DecidesByOdometryBetweenPoses) {
  give_map();
  ask(true);
  (void)give_pose();
  const std::size_t num_decisions = bus_.count("EXPLORATION");
  for (int i = 1; i <= 4; ++i) {
    utime_us_ += 500'000;
    give_odometry(0.3 * i);
    EXPECT_EQ(bus_.count("EXPLORATION"), num_decisions + static_cast<std::size_t>(i));
    const auto exploration = bus_.last<nodmap::exploration_t>("EXPLORATION");
    ASSERT_GT(exploration.num_points, 0);
    // A path begins in the middle of a planning cell.
    EXPECT_NEAR(exploration.x_m.front(), 0.3 * i, 0.15);
  }
  utime_us_ += 4'000'000;
  give_odometry(1.5);
  EXPECT_EQ(bus_.count("EXPLORATION"), num_decisions + 4) << "there was no pose for 6 s";
  (void)give_pose();
  EXPECT_EQ(bus_.count("EXPLORATION"), num_decisions + 5);
}

TEST_F(ExplorerNodeTest, WaitsForAPoseAfterTheBaseDriverHasRestarted) {
  give_map();
  ask(true);
  (void)give_pose();
  (void)give_pose();
  const std::size_t num_decisions = bus_.count("EXPLORATION");
  odometry_seq_ = 0;
  utime_us_ += 490'000;
  give_odometry(0.0);
  utime_us_ += 10'000;
  give_odometry(0.0);
  EXPECT_EQ(bus_.count("EXPLORATION"), num_decisions);
  (void)give_pose();
  EXPECT_EQ(bus_.count("EXPLORATION"), num_decisions + 1);
}

TEST_F(ExplorerNodeTest, DecidesAtOnceWhenTheNavigatorHasArrived) {
  give_map();
  ask(true);
  (void)give_pose();
  const std::size_t num_decisions = bus_.count("EXPLORATION");
  utime_us_ += 200'000;
  give_odometry(0.1);
  EXPECT_EQ(bus_.count("EXPLORATION"), num_decisions);
  nodmap::navigation_t navigation{};
  navigation.behaviour = nodmap::navigation_t::ARRIVED;
  navigation.goal_utime = 1;
  bus_.deliver("NAVIGATION", navigation);
  give_odometry(0.1);
  EXPECT_EQ(bus_.count("EXPLORATION"), num_decisions) << "at another goal";
  navigation.goal_utime = bus_.last<nodmap::goal_t>("GOAL").utime;
  for (int i = 0; i < 2; ++i) {
    bus_.deliver("NAVIGATION", navigation);
    give_odometry(0.1);
    EXPECT_EQ(bus_.count("EXPLORATION"), num_decisions + 1) << "once";
  }
}

// Both times are shorter than patience.stuck_s.
TEST_F(ExplorerNodeTest, OnlyAPathThatIsMissingToItsOwnGoalIsAFailure) {
  give_map();
  ask(true);
  (void)give_pose();
  nodmap::path_t path{};
  path.state = nodmap::path_t::NO_PATH;
  path.goal_utime = bus_.last<nodmap::goal_t>("GOAL").utime;
  const auto wait = [&] {
    const double wait_s = ExplorerParams{}.patience.no_path_s + 1.0;
    for (double waited_s = 0.0; waited_s < wait_s; waited_s += 0.5) {
      path.utime = utime_us_;
      bus_.deliver("PATH", path);
      (void)give_pose();
    }
  };
  wait();
  EXPECT_EQ(node_.metrics()["failures"], 1);
  ASSERT_NE(bus_.last<nodmap::goal_t>("GOAL").utime, path.goal_utime);
  wait();
  EXPECT_EQ(node_.metrics()["failures"], 1);
}

// The navigator halts, because another process is down, or is down itself.
TEST_F(ExplorerNodeTest, APathThatWasMissingOnceIsNotMissingForEver) {
  give_map();
  ask(true);
  (void)give_pose();
  nodmap::path_t path{};
  path.state = nodmap::path_t::NO_PATH;
  path.goal_utime = bus_.last<nodmap::goal_t>("GOAL").utime;
  path.utime = utime_us_;
  bus_.deliver("PATH", path);
  for (double waited_s = 0.0; waited_s < ExplorerParams{}.patience.no_path_s + 1.0;
       waited_s += 0.5) {
    (void)give_pose();
  }
  EXPECT_EQ(node_.metrics()["failures"], 0);
}

// A navigator that is started later would roam without a goal.
TEST_F(ExplorerNodeTest, AfterItsEndTheGoalIsRepeatedUntilTheNavigatorHasIt) {
  give_map();
  ask(true);
  (void)give_pose();
  ask(false);
  const auto goal = bus_.last<nodmap::goal_t>("GOAL");
  std::size_t num_goals = bus_.count("GOAL");
  for (int i = 0; i < 4; ++i) {
    (void)give_pose();
  }
  EXPECT_EQ(bus_.count("GOAL"), num_goals + 2) << "in two seconds";
  EXPECT_EQ(bus_.last<nodmap::goal_t>("GOAL").utime, goal.utime) << "it is the same goal";
  const auto count_repetitions = [&](std::int64_t goal_utime) {
    num_goals = bus_.count("GOAL");
    for (int i = 0; i < 4; ++i) {
      nodmap::navigation_t navigation{};
      navigation.utime = utime_us_;
      navigation.goal_utime = goal_utime;
      bus_.deliver("NAVIGATION", navigation);
      (void)give_pose();
    }
    return bus_.count("GOAL") - num_goals;
  };
  EXPECT_EQ(count_repetitions(goal.utime), 0U) << "the navigator has taken it";
  utime_us_ += 5'000'000;
  EXPECT_EQ(count_repetitions(0), 2U) << "a navigator that was silent has no goal";
  EXPECT_EQ(count_repetitions(goal.utime), 0U);
  EXPECT_EQ(count_repetitions(0), 0U) << "somebody has cancelled it";
  utime_us_ += 5'000'000;
  EXPECT_EQ(count_repetitions(0), 0U);
}

TEST_F(ExplorerNodeTest, AfterItsEndTheGoalOfAnotherSenderIsNotOverruled) {
  give_map();
  ask(true);
  (void)give_pose();
  ask(false);
  const auto goal = bus_.last<nodmap::goal_t>("GOAL");
  auto others = goal;
  others.position_m[0] += 1.0;
  bus_.deliver("GOAL", others);
  const std::size_t num_goals = bus_.count("GOAL");
  for (int i = 0; i < 4; ++i) {
    (void)give_pose();
  }
  EXPECT_EQ(bus_.count("GOAL"), num_goals);
}

// The kept place is a position in a map that no longer exists.
TEST_F(ExplorerNodeTest, ANewMapAfterItsEndRenewsThePlaceWhereTheRobotIs) {
  give_map(7);
  ask(true);
  (void)give_pose();
  ask(false);
  give_map(0);
  utime_us_ += 10'000;
  give_odometry(1.5);
  EXPECT_EQ(bus_.last<nodmap::goal_t>("GOAL").position_m[0], 1.5);
}

// Who asks for an exploration of what is known already must see that it has been started.
TEST_F(ExplorerNodeTest, SaysThatItStartsBeforeTheFirstDecisionEndsIt) {
  world_.add_wall({-0.5, -1.0}, {-0.5, 1.0});
  world_.add_wall({5.0, -1.0}, {5.0, 1.0});
  for (const double x : {0.0, 4.0}) {
    for (int i = 0; i < 4; ++i) {
      world_.scan({x, 0.0, 0.5 * geometry::kPi * i});
    }
  }
  give_map();
  (void)give_pose();
  ask(true);
  EXPECT_EQ(bus_.last<nodmap::exploration_t>("EXPLORATION").state,
            nodmap::exploration_t::EXPLORING);
  EXPECT_EQ(give_pose().state, nodmap::exploration_t::HOME);
}

// Meanwhile somebody may have moved the robot, which must not drive back.
TEST_F(ExplorerNodeTest, ThePlaceWhereItEndedIsRenewedWhenTheRobotIsReleased) {
  give_map();
  ask(true);
  (void)give_pose();
  stop(true);
  ask(false);
  EXPECT_EQ(bus_.last<nodmap::goal_t>("GOAL").position_m[0], 0.0);
  utime_us_ += 10'000;
  give_odometry(1.5);
  EXPECT_EQ(bus_.last<nodmap::goal_t>("GOAL").position_m[0], 0.0);
  stop(false);
  utime_us_ += 10'000;
  give_odometry(1.5);
  EXPECT_EQ(bus_.last<nodmap::goal_t>("GOAL").position_m[0], 1.5);
}

TEST_F(ExplorerNodeTest, ANewMapEndsTheExplorationAndTheRobotStaysWhereItIs) {
  give_map(7);
  ask(true);
  (void)give_pose();
  give_map(8);
  EXPECT_EQ(give_pose().state, nodmap::exploration_t::EXPLORING);
  give_map(0);
  const std::size_t num_goals = bus_.count("GOAL");
  EXPECT_EQ(give_pose().reason, "The 2D map was restarted.");
  // The old goal is a position in a map that no longer exists.
  ASSERT_EQ(bus_.count("GOAL"), num_goals + 1);
  const auto goal = bus_.last<nodmap::goal_t>("GOAL");
  EXPECT_TRUE(goal.is_active);
  EXPECT_EQ(goal.position_m[0], 0.0);
  EXPECT_EQ(goal.position_m[1], 0.0);
  (void)give_pose();
  EXPECT_EQ(bus_.count("GOAL"), num_goals + 1);
}

// The tile's first cell is 2^31, which would be -2^31, far before the grid's memory.
TEST_F(ExplorerNodeTest, ATileWhoseCellsCannotBeCountedIsRefused) {
  give_map();
  nodmap::grid_chunk_t tile{};
  tile.num_chunks = 1;
  tile.cell_size_m = world_.map().cell_size_m;
  tile.origin_x_m = tile.cell_size_m;
  tile.grid_width = tile.tile_x = std::numeric_limits<std::int32_t>::max();
  tile.grid_height = tile.tile_width = tile.tile_height = tile.num_cells = 1;
  tile.cells = {0};
  bus_.deliver("MAP_2D", tile);
  EXPECT_EQ(counts_.rejected().at("implausible_map_tile"), 1);
}

TEST_F(ExplorerNodeTest, ImplausibleMessagesAreCounted) {
  nodmap::grid_chunk_t tile{};
  tile.cell_size_m = 0.05;
  tile.tile_width = tile.tile_height = 4;
  tile.num_cells = 1;
  tile.cells = {0};
  bus_.deliver("MAP_2D", tile);
  tile.origin_x_m = std::numeric_limits<double>::infinity();
  bus_.deliver("MAP_2D", tile);
  bus_.deliver("POSE_2D", nodmap::pose_t{});
  EXPECT_EQ(counts_.rejected().at("implausible_map_tile"), 2);
  EXPECT_EQ(counts_.rejected().at("implausible_pose"), 1);
}

}  // namespace node_test
}  // namespace nodmap::explorer
