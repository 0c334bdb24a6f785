// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/node.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "modules/explorer/test/explorer_node_fixture.hpp"

namespace nodmap::explorer {
namespace node_test {

using test::ExplorerNodeTest;

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

TEST_F(ExplorerNodeTest, DecidesNothingWithoutATrustworthyPose) {
  give_map();
  ask(true);
  (void)give_pose();
  const std::int64_t num_before = num_decisions();
  const auto exploration = give_pose(nodmap::pose_t::LOST);
  EXPECT_EQ(num_decisions(), num_before);
  EXPECT_EQ(exploration.state, nodmap::exploration_t::EXPLORING);
  EXPECT_EQ(exploration.reason, "2D SLAM is lost: the exploration waits for a pose.");
  EXPECT_EQ(node_.health().state, node::HealthState::kDegraded);
}

// 2D SLAM is down. Who wants to end the exploration needs EXPLORATION most.
TEST_F(ExplorerNodeTest, WithoutPosesItSaysWhyItWaits) {
  give_map();
  ask(true);
  const auto wait_s = [this](int seconds) {
    for (int i = 0; i < 2 * seconds; ++i) {
      const std::size_t num_before = bus_.count("EXPLORATION");
      utime_us_ += 500'000;
      give_navigation(nodmap::navigation_t::STEER);
      give_odometry(0.0);
      EXPECT_EQ(bus_.count("EXPLORATION"), num_before + 1) << i;
    }
  };
  give_navigation(nodmap::navigation_t::STEER);
  (void)give_pose();
  wait_s(14);
  const auto exploration = bus_.last<nodmap::exploration_t>("EXPLORATION");
  EXPECT_EQ(exploration.state, nodmap::exploration_t::EXPLORING);
  EXPECT_EQ(exploration.reason, "No pose comes from 2D SLAM: the exploration waits for one.");
  EXPECT_EQ(node_.health().state, node::HealthState::kOk) << "no pose for 14 s, a halt of 9 s";
  wait_s(1);
  EXPECT_EQ(node_.health().state, node::HealthState::kDegraded);
  EXPECT_EQ(node_.health().reason, exploration.reason);
  EXPECT_NE(give_pose().reason, exploration.reason);
  EXPECT_EQ(node_.health().state, node::HealthState::kOk) << node_.health().reason;
}

TEST_F(ExplorerNodeTest, ItsStateIsKnownBeforeTheFirstPose) {
  ::nodmap::test::MemoryBus bus;
  node::Context context{bus, counts_, {}};
  const ExplorerNode explorer(context, {});
  bus.deliver("ODOMETRY",
              node::write_odometry(time::from_utime(500'000), geometry::SE3::Identity()));
  ASSERT_EQ(bus.count("EXPLORATION"), 1U);
  const auto exploration = bus.last<nodmap::exploration_t>("EXPLORATION");
  EXPECT_EQ(exploration.state, nodmap::exploration_t::IDLE);
  EXPECT_EQ(exploration.reason, "Waiting to be started.");
}

TEST_F(ExplorerNodeTest, SaysAtOnceThatItHasBeenEnded) {
  ask(true);
  ask(false);
  const auto exploration = bus_.last<nodmap::exploration_t>("EXPLORATION");
  EXPECT_EQ(exploration.state, nodmap::exploration_t::IDLE);
  EXPECT_EQ(exploration.reason, "Ended by somebody.");
}

// One that is refused leaves the pose before in force; one of another time must be followed by a
// better one.
TEST_F(ExplorerNodeTest, APoseWithAWrongStampCountsAsNone) {
  utime_us_ = 100'000'000;
  give_map();
  ask(true);
  (void)give_pose();
  const std::int64_t num_before = num_decisions();
  nodmap::pose_t pose = pose_message();
  pose.utime = -1;
  bus_.deliver("POSE_2D", pose);
  EXPECT_EQ(counts_.rejected().at("implausible_pose"), 1);
  utime_us_ += 500'000;
  give_odometry(0.0);
  EXPECT_EQ(num_decisions(), num_before + 1);
  for (const std::int64_t wrong_by : {-6'000'000, 6'000'000}) {
    utime_us_ += 500'000;
    pose.utime = utime_us_ + wrong_by;
    bus_.deliver("POSE_2D", pose);
    give_odometry(0.0);
    EXPECT_EQ(num_decisions(), num_before + 1) << wrong_by;
  }
  (void)give_pose();
  EXPECT_EQ(num_decisions(), num_before + 2);
}

// Poses of 2D SLAM come with level scans: one a second when the robot is slow.
TEST_F(ExplorerNodeTest, DecidesByOdometryBetweenPoses) {
  give_map();
  ask(true);
  (void)give_pose();
  const std::int64_t num_before = num_decisions();
  for (int i = 1; i <= 4; ++i) {
    utime_us_ += 500'000;
    give_odometry(0.3 * i);
    EXPECT_EQ(num_decisions(), num_before + i);
    const auto exploration = bus_.last<nodmap::exploration_t>("EXPLORATION");
    ASSERT_GT(exploration.num_points, 0);
    // A path begins in the middle of a planning cell.
    EXPECT_NEAR(exploration.x_m.front(), 0.3 * i, 0.15);
  }
  utime_us_ += 4'000'000;
  give_odometry(1.5);
  EXPECT_EQ(num_decisions(), num_before + 4) << "there was no pose for 6 s";
  (void)give_pose();
  EXPECT_EQ(num_decisions(), num_before + 5);
}

TEST_F(ExplorerNodeTest, WaitsForAPoseAfterTheBaseDriverHasRestarted) {
  give_map();
  ask(true);
  (void)give_pose();
  (void)give_pose();
  const std::int64_t num_before = num_decisions();
  odometry_seq_ = 0;
  utime_us_ += 490'000;
  give_odometry(0.0);
  utime_us_ += 10'000;
  give_odometry(0.0);
  EXPECT_EQ(num_decisions(), num_before);
  (void)give_pose();
  EXPECT_EQ(num_decisions(), num_before + 1);
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
  const std::int64_t goal_utime = bus_.last<nodmap::goal_t>("GOAL").utime;
  const auto wait = [&] {
    const double wait_s = ExplorerParams{}.patience.no_path_s + 1.0;
    for (double waited_s = 0.0; waited_s < wait_s; waited_s += 0.5) {
      give_no_path(goal_utime);
      give_navigation(nodmap::navigation_t::BRAKE);
      (void)give_pose();
    }
  };
  wait();
  EXPECT_EQ(node_.metrics()["failures"], 1);
  ASSERT_NE(bus_.last<nodmap::goal_t>("GOAL").utime, goal_utime);
  wait();
  EXPECT_EQ(node_.metrics()["failures"], 1);
}

// The navigator halts, because another process is down, or is down itself.
TEST_F(ExplorerNodeTest, APathThatWasMissingOnceIsNotMissingForEver) {
  give_map();
  ask(true);
  (void)give_pose();
  give_no_path(bus_.last<nodmap::goal_t>("GOAL").utime);
  give_navigation(nodmap::navigation_t::BRAKE);
  for (double waited_s = 0.0; waited_s < ExplorerParams{}.patience.no_path_s + 1.0;
       waited_s += 0.5) {
    (void)give_pose();
  }
  EXPECT_EQ(node_.metrics()["failures"], 0);
}

// A stop at the base, a laser that is out, or no navigator: what the robot has not tried has not
// failed. It would give up all places, and report that everything has been seen. Two minutes are
// eight times as long as it takes to give up a place.
TEST_F(ExplorerNodeTest, ARobotThatMayNotDriveGivesUpNoPlace) {
  give_map();
  ask(true);
  const auto wait_min = [&](int minutes, const auto& each) {
    for (int i = 0; i < 120 * minutes; ++i) {
      each();
      EXPECT_EQ(give_pose().state, nodmap::exploration_t::EXPLORING);
    }
  };
  wait_min(2, [] {});
  EXPECT_EQ(node_.metrics()["failures"], 0);
  EXPECT_EQ(node_.health().state, node::HealthState::kDegraded);
  EXPECT_NE(node_.health().reason.find("No nodmap-navigator"), std::string::npos);
  wait_min(2, [&] { give_navigation(nodmap::navigation_t::HALT, "No scans."); });
  EXPECT_EQ(node_.metrics()["failures"], 0);
  EXPECT_EQ(node_.health().reason, "The robot may not drive: No scans.");
  EXPECT_EQ(bus_.last<nodmap::exploration_t>("EXPLORATION").reason, node_.health().reason);
  wait_min(1, [&] { give_navigation(nodmap::navigation_t::STEER); });
  EXPECT_GT(node_.metrics()["failures"], 0) << "it may drive and comes no nearer";
  EXPECT_EQ(node_.health().state, node::HealthState::kOk);
}

// The explorer does not know the geofence. The navigator halts, and goes on saying that there is no
// path.
TEST_F(ExplorerNodeTest, AGoalOutsideTheGeofenceFails) {
  give_map();
  ask(true);
  (void)give_pose();
  const std::int64_t goal_utime = bus_.last<nodmap::goal_t>("GOAL").utime;
  for (double waited_s = 0.0; waited_s < ExplorerParams{}.patience.no_path_s + 1.0;
       waited_s += 0.5) {
    give_no_path(goal_utime);
    give_navigation(nodmap::navigation_t::HALT, "The goal is outside the geofence.");
    (void)give_pose();
  }
  EXPECT_EQ(node_.metrics()["failures"], 1);
  EXPECT_NE(bus_.last<nodmap::goal_t>("GOAL").utime, goal_utime);
}

// A person has stopped the robot: what kept it from driving before is no fault any more.
TEST_F(ExplorerNodeTest, AHaltIsForgottenWhileTheRobotIsStopped) {
  give_map();
  ask(true);
  for (int i = 0; i < 5; ++i) {
    give_navigation(nodmap::navigation_t::HALT, "No scans.");
    (void)give_pose();
  }
  nodmap::stop_t stop{};
  stop.is_stopped = 1;
  bus_.deliver("STOP", stop);
  for (int i = 0; i < 60; ++i) {
    (void)give_pose();
  }
  EXPECT_EQ(node_.health().state, node::HealthState::kOk) << node_.health().reason;
}

TEST_F(ExplorerNodeTest, AHaltBeforeTheExplorationIsNoFault) {
  give_map();
  for (int i = 0; i < 60; ++i) {
    (void)give_pose();
  }
  ask(true);
  (void)give_pose();
  EXPECT_EQ(node_.health().state, node::HealthState::kOk);
}

TEST_F(ExplorerNodeTest, OnlyTheMapOfTheProcessThatSendsThePosesIsUsed) {
  constexpr bus::Sender kOther{0x7F000001, 40'002};
  give_map(3);
  ask(true);
  EXPECT_EQ(give_pose().state, nodmap::exploration_t::EXPLORING);
  bus_.deliver_from(kOther, "MAP_2D", map_message(0));
  bus_.deliver_from(kOther, "MAP_2D", map_message(1));
  EXPECT_EQ(counts_.rejected().at("map_tile_without_pose"), 2);
  EXPECT_EQ(give_pose().state, nodmap::exploration_t::EXPLORING);
  bus_.deliver_from(kOther, "POSE_2D", pose_message());
  EXPECT_EQ(give_pose().reason, "The 2D map was restarted.");
}

TEST_F(ExplorerNodeTest, OneLateTileIsNoNewMap) {
  give_map(7);
  ask(true);
  (void)give_pose();
  give_map(8);
  give_map(7);
  EXPECT_EQ(give_pose().state, nodmap::exploration_t::EXPLORING);
  give_map(8);
  give_map(7);
  EXPECT_EQ(give_pose().state, nodmap::exploration_t::EXPLORING);
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
