// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/explorer.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "modules/explorer/test/grid_world.hpp"

namespace nodmap::explorer {
namespace explorer_test {

using test::Exploration;
using test::explore;
using test::GridWorld;
using test::make_office;

ExplorerParams with(Policy policy) {
  ExplorerParams params;
  params.policy = policy;
  return params;
}

// Time to drive 450 m, which is the corridor of 16 m up and down 14 times.
constexpr double kMaxS = 900.0;
// Places that show less than view.min_gain_m2, 0.4 m2, are not visited. Seven of them would be 2 %
// of the floor.
constexpr double kSeenRatio = 0.98;

class Offices : public ::testing::TestWithParam<int> {};

// A corridor of 16 m with four rooms on each side.
TEST_P(Offices, AreSeenCompletelyAndTheRobotReturnsHome) {
  GridWorld office = make_office(4, static_cast<std::uint64_t>(GetParam()));
  const Exploration exploration = explore(office, with(Policy::kTour), kMaxS);
  EXPECT_EQ(exploration.state, State::kHome);
  EXPECT_GE(exploration.seen_ratio, kSeenRatio);
  EXPECT_LE(exploration.from_home_m, 0.05);
}
INSTANTIATE_TEST_SUITE_P(Seeds, Offices, ::testing::Range(1000, 1003));

// The policy that the tour is compared with (bench/exploration.py) must work as well.
TEST(Explorer, TheNearestFrontierPolicyAlsoSeesTheOffice) {
  GridWorld office = make_office(4, 1000);
  const Exploration exploration = explore(office, with(Policy::kNearestFrontier), kMaxS);
  EXPECT_EQ(exploration.state, State::kHome);
  EXPECT_GE(exploration.seen_ratio, kSeenRatio);
}

// A closed room of 4 m x 3 m, all of it known.
GridWorld known_room() {
  GridWorld room({-2.5, -2.0}, {2.5, 2.0});
  room.add_wall({-2.0, -1.5}, {2.0, -1.5});
  room.add_wall({-2.0, 1.5}, {2.0, 1.5});
  room.add_wall({-2.0, -1.5}, {-2.0, 1.5});
  room.add_wall({2.0, -1.5}, {2.0, 1.5});
  for (int i = 0; i < 4; ++i) {
    room.scan({0.0, 0.0, 0.5 * geometry::kPi * i});
  }
  return room;
}

TEST(Explorer, InAKnownRoomItEndsAtOnce) {
  const GridWorld room = known_room();
  Explorer explorer{ExplorerParams{}};
  EXPECT_EQ(explorer.decide({}).state, State::kIdle);
  explorer.start();
  EXPECT_FALSE(explorer.decide({}).goal) << "there is no map yet";
  ASSERT_TRUE(explorer.add(room.map()));
  const Decision decision = explorer.decide({.stamp = time::Timestamp(1s), .T_map_base = {}});
  EXPECT_EQ(decision.state, State::kHome);
  EXPECT_FALSE(decision.goal);
  EXPECT_NEAR(decision.seen_m2, 3.9 * 2.9, 0.8);  // walls take up to a planning cell more
}

// The tile that shows the robot's place comes later.
TEST(Explorer, WaitsUntilTheMapShowsFreeGroundAroundTheRobot) {
  const GridWorld room = known_room();
  Explorer explorer{ExplorerParams{}};
  explorer.start();
  MapTile elsewhere = room.map();
  elsewhere.first += Cell(400, 0);
  ASSERT_TRUE(explorer.add(elsewhere));
  const Decision decision = explorer.decide({.stamp = {}, .T_map_base = {}});
  EXPECT_EQ(decision.state, State::kExploring);
  EXPECT_FALSE(decision.goal);
  EXPECT_EQ(decision.reason, "The 2D map does not show free ground around the robot.");
  ASSERT_TRUE(explorer.add(room.map()));
  EXPECT_EQ(explorer.decide({.stamp = time::Timestamp(1s), .T_map_base = {}}).state, State::kHome);
}

// An explorer that began at (-1, 0) m, and now knows the whole room.
Explorer begun_away_from_home() {
  GridWorld unknown({-2.5, -2.0}, {2.5, 2.0});
  unknown.scan({-1.0, 0.0, 0.0});
  Explorer explorer{ExplorerParams{}};
  explorer.start();
  EXPECT_TRUE(explorer.add(unknown.map()));
  EXPECT_EQ(explorer.decide({.stamp = {}, .T_map_base = {-1.0, 0.0, 0.0}}).state,
            State::kExploring);
  EXPECT_TRUE(explorer.add(known_room().map()));
  return explorer;
}

TEST(Explorer, ReturnsToThePlaceWhereItBegan) {
  Explorer explorer = begun_away_from_home();
  const Decision decision =
      explorer.decide({.stamp = time::Timestamp(500ms), .T_map_base = {1.0, 0.5, 0.0}});
  EXPECT_EQ(decision.state, State::kReturning);
  ASSERT_TRUE(decision.goal);
  EXPECT_EQ(decision.goal->p_map, Eigen::Vector2d(-1.0, 0.0));
  EXPECT_EQ(decision.goal->tolerance_m, ExplorerParams{}.home_tolerance_m);
  EXPECT_EQ(explorer.decide({.stamp = time::Timestamp(1s), .T_map_base = {-0.97, 0.0, 0.0}}).state,
            State::kHome);
}

// A door has been closed. A pause, as during a STOP, does not count.
TEST(Explorer, EndsWhenThereIsNoPathHome) {
  Explorer explorer = begun_away_from_home();
  const auto decide = [&](double time_s, bool has_no_path) {
    return explorer.decide({.stamp = time::Timestamp(time::from_seconds(time_s)),
                            .T_map_base = {1.0, 0.5, 0.0},
                            .has_no_path = has_no_path});
  };
  (void)decide(0.5, false);
  ASSERT_EQ(explorer.state(), State::kReturning);
  (void)decide(1.0, true);
  (void)decide(100.0, true);
  const double stuck_s = ExplorerParams{}.patience.stuck_s;
  for (double time_s = 100.5; time_s <= 100.0 + stuck_s; time_s += 0.5) {
    ASSERT_EQ(decide(time_s, true).state, State::kReturning) << time_s;
  }
  const Decision decision = decide(100.5 + stuck_s, true);
  EXPECT_EQ(decision.state, State::kIdle);
  EXPECT_EQ(decision.reason, "Everything has been seen, but there is no path home.");
  EXPECT_FALSE(decision.goal);
}

// The map shows a wall through the room, of which the navigator may know better.
TEST(Explorer, WhereTheMapShowsNoPathHomeTheNavigatorIsAskedForOne) {
  Explorer explorer = begun_away_from_home();
  GridWorld divided({-2.5, -2.0}, {2.5, 2.0});
  divided.add_wall({-2.0, -1.5}, {2.0, -1.5});
  divided.add_wall({-2.0, 1.5}, {2.0, 1.5});
  divided.add_wall({0.5, -1.5}, {0.5, 1.5});
  divided.add_wall({2.0, -1.5}, {2.0, 1.5});
  for (int i = 0; i < 4; ++i) {
    divided.scan({1.2, 0.0, 0.5 * geometry::kPi * i});
  }
  ASSERT_TRUE(explorer.add(divided.map()));
  const auto decide = [&](double time_s, const geometry::SE2& T_map_base, bool has_no_path) {
    return explorer.decide({.stamp = time::Timestamp(time::from_seconds(time_s)),
                            .T_map_base = T_map_base,
                            .has_no_path = has_no_path,
                            .has_arrived = !has_no_path});
  };
  const Decision first = decide(1.0, {1.5, 1.0, 0.0}, false);
  ASSERT_EQ(first.state, State::kReturning);
  ASSERT_GT(first.goal->p_map.x(), 0.5) << "before the wall";
  const geometry::SE2 T_map_base{first.goal->p_map.x(), first.goal->p_map.y(), 0.0};
  const Eigen::Vector2d home(-1.0, 0.0);
  double time_s = 2.0;
  for (; time_s < 2.0 + ExplorerParams{}.patience.stuck_s; time_s += 0.5) {
    const Decision decision = decide(time_s, T_map_base, true);
    ASSERT_EQ(decision.state, State::kReturning) << time_s;
    ASSERT_EQ(decision.goal->p_map, home) << time_s;
  }
  EXPECT_EQ(decide(time_s + 0.5, T_map_base, true).reason,
            "Everything has been seen, but there is no path home.");
}

// A robot that cannot move, at the start of a corridor with much unknown ground at its end.
class Stuck : public ::testing::Test {
 protected:
  Stuck() : world_({-8.0, -8.0}, {8.0, 8.0}) {
    world_.add_wall({-0.5, -1.0}, {4.0, -1.0});
    world_.add_wall({-0.5, 1.0}, {4.0, 1.0});
    world_.scan({0.0, 0.0, 0.0});
    EXPECT_TRUE(explorer_.add(world_.map()));
    explorer_.start();
  }
  Decision decide(double time_s, bool has_no_path = false, const geometry::SE2& T_map_base = {}) {
    return explorer_.decide({.stamp = time::Timestamp(time::from_seconds(time_s)),
                             .T_map_base = T_map_base,
                             .has_no_path = has_no_path});
  }

  GridWorld world_;
  Explorer explorer_{ExplorerParams{}};
};

TEST_F(Stuck, GivesUpAViewpointThatItDoesNotReachForAnotherOne) {
  const Eigen::Vector2d first = decide(0.0).tour.front().p_map;
  const double stuck_s = ExplorerParams{}.patience.stuck_s;
  for (double time_s = 0.5; time_s <= stuck_s; time_s += 0.5) {
    ASSERT_EQ(decide(time_s).tour.front().p_map, first) << time_s;
  }
  const Decision decision = decide(stuck_s + 0.5);
  ASSERT_FALSE(decision.tour.empty());
  EXPECT_GT((decision.tour.front().p_map - first).norm(), 0.5);
  EXPECT_EQ(explorer_.num_failures(), 1U);
}

// It has waited for longer than no_path_s before; only the time without a path counts.
TEST_F(Stuck, OnlyTheTimeWithoutAPathCounts) {
  const double no_path_s = ExplorerParams{}.patience.no_path_s;
  double time_s = 0.0;
  for (; time_s < no_path_s + 1.0; time_s += 0.5) {
    (void)decide(time_s);
  }
  const double since_s = time_s;
  for (; time_s <= since_s + 0.5 * no_path_s; time_s += 0.5) {
    (void)decide(time_s, true);
  }
  EXPECT_EQ(explorer_.num_failures(), 0U);
  (void)decide(time_s, false);
  EXPECT_EQ(explorer_.num_failures(), 0U);
}

TEST_F(Stuck, WithoutAPathItGivesUpSooner) {
  const double no_path_s = ExplorerParams{}.patience.no_path_s;
  (void)decide(0.0);
  for (double time_s = 0.5; time_s <= no_path_s + 1.0; time_s += 0.5) {
    EXPECT_EQ(explorer_.num_failures(), 0U);
    (void)decide(time_s, true);
  }
  EXPECT_EQ(explorer_.num_failures(), 1U);
}

// A corridor with openings at its sides, so that several viewpoints lie on one line.
TEST(Explorer, WithoutAPathToTheLastViewpointOfALineTheFirstIsStillDrivenTo) {
  GridWorld corridor({-8.0, -8.0}, {16.0, 8.0});
  for (const double y : {-0.6, 0.6}) {
    corridor.add_wall({-0.5, y}, {3.0, y});
    corridor.add_wall({4.0, y}, {6.0, y});
    corridor.add_wall({7.0, y}, {12.0, y});
  }
  corridor.add_wall({-0.5, -0.6}, {-0.5, 0.6});
  for (int i = 0; i < 4; ++i) {
    corridor.scan({0.0, 0.0, 0.5 * geometry::kPi * i});
  }
  Explorer explorer{ExplorerParams{}};
  ASSERT_TRUE(explorer.add(corridor.map()));
  explorer.start();
  const auto decide = [&](double time_s) {
    return explorer.decide({.stamp = time::Timestamp(time::from_seconds(time_s)),
                            .T_map_base = {},
                            .has_no_path = time_s > 0.0});
  };
  const Decision first = decide(0.0);
  const Eigen::Vector2d nearest = first.tour.front().p_map;
  ASSERT_GT(first.goal->p_map.norm(), nearest.norm() + 0.7) << "passes several viewpoints";
  for (double time_s = 0.5; explorer.num_failures() == 0; time_s += 0.5) {
    ASSERT_LT(time_s, 2.0 * ExplorerParams{}.patience.no_path_s);
    (void)decide(time_s);
  }
  const Decision next = decide(ExplorerParams{}.patience.no_path_s + 2.0);
  EXPECT_LT((next.tour.front().p_map - nearest).norm(), 0.5);
  EXPECT_NE(next.goal->p_map, first.goal->p_map);
}

// The map shows 0.4 m more of a corridor each second, and the robot drives as fast.
TEST(Explorer, ProgressBehindARecedingFrontierIsProgress) {
  GridWorld corridor({-4.0, -4.0}, {30.0, 4.0});
  corridor.add_wall({-0.5, -1.0}, {29.0, -1.0});
  corridor.add_wall({-0.5, 1.0}, {29.0, 1.0});
  corridor.add_wall({-0.5, -1.0}, {-0.5, 1.0});
  Explorer explorer{ExplorerParams{}};
  explorer.start();
  for (int second = 0; second < 40; ++second) {
    const geometry::SE2 T_map_base{0.4 * second, 0.0, 0.0};
    corridor.scan(T_map_base);
    ASSERT_TRUE(explorer.add(corridor.map()));
    (void)explorer.decide({.stamp = time::Timestamp(1s * second), .T_map_base = T_map_base});
    ASSERT_EQ(explorer.num_failures(), 0U) << second << " s";
  }
}

// While the robot is stopped, no decisions are made.
TEST_F(Stuck, APauseDoesNotCountAsAFailure) {
  const Eigen::Vector2d first = decide(0.0).tour.front().p_map;
  EXPECT_EQ(decide(100.0).tour.front().p_map, first);
  EXPECT_EQ(explorer_.num_failures(), 0U);
}

// The map does not yet show what was seen from a viewpoint when the robot drives on.
TEST_F(Stuck, AViewpointThatWasVisitedIsLeftOutUntilTheMapShowsWhatWasSeen) {
  const auto is_in_tour = [](const Decision& decision, const Eigen::Vector2d& p_map) {
    return std::ranges::any_of(
        decision.tour, [&](const Viewpoint& viewpoint) { return viewpoint.p_map == p_map; });
  };
  const Eigen::Vector2d first = decide(0.0).tour.front().p_map;
  const double look_s = ExplorerParams{}.patience.look_s;
  EXPECT_TRUE(is_in_tour(decide(0.5), first));
  const Eigen::Vector2d beside = first - Eigen::Vector2d(0.35, 0.0);  // the tolerance is 0.3 m
  EXPECT_FALSE(is_in_tour(decide(1.0, false, {beside.x(), beside.y(), 0.0}), first));
  EXPECT_FALSE(is_in_tour(decide(1.0 + look_s - 0.1), first));
  EXPECT_TRUE(is_in_tour(decide(1.0 + look_s + 0.1), first));
  EXPECT_EQ(explorer_.num_failures(), 0U);
}

TEST_F(Stuck, GivesUpAllViewpointsInTheEnd) {
  double time_s = 0.0;
  while (explorer_.state() == State::kExploring && time_s < 1e5) {
    time_s += 1.0;
    (void)decide(time_s);
  }
  EXPECT_EQ(explorer_.state(), State::kHome);
}

}  // namespace explorer_test
}  // namespace nodmap::explorer
