// SPDX-License-Identifier: BSD-3-Clause
// Compared with values computed by hand.
#include "modules/viewer/foxglove/scene_views.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "modules/viewer/foxglove/test/robot_maps.hpp"
#include "modules/viewer/foxglove/test/robot_messages.hpp"

namespace nodmap::foxglove {
namespace scene_views_test {

TEST(Scene, TheCorridorBeginsAtTheRobotsFront) {
  const Json update = corridor_scene(foxglove::test::navigation_at(0.0), {.length_m = 0.6});
  ASSERT_EQ(update["entities"].size(), 1U);
  const Json& cube = update["entities"][0]["cubes"][0];
  EXPECT_DOUBLE_EQ(cube["size"]["x"], 1.5);
  // Half of the body's length, then half of the corridor's.
  EXPECT_DOUBLE_EQ(cube["pose"]["position"]["x"], 0.3 + 0.75);
  EXPECT_EQ(update["entities"][0]["texts"][0]["text"], "STEER");
}

// From 0.4 m above the ground, 30 degrees down: the ray hits the ground after 0.8 m, that is 0.8
// cos 30 ahead.
TEST(Scene, TheAreaOfInterestEndsOnTheGround) {
  nodmap::pitch_command_t command{};
  command.pitch_min_rad = -std::numbers::pi / 6.0;
  command.pitch_max_rad = 0.0;
  const Json update = area_of_interest_scene(command, {0.1, 0.0, 0.4}, {});
  const Json& points = update["entities"][0]["lines"][0]["points"];
  EXPECT_NEAR(points[1]["x"], 0.1 + 0.8 * std::cos(std::numbers::pi / 6.0), 1e-12);
  EXPECT_NEAR(points[1]["z"], 0.0, 1e-12);
  EXPECT_NEAR(points[5]["x"], 3.1, 1e-12);
  EXPECT_NEAR(points[5]["z"], 0.4, 1e-12);
}

TEST(Scene, AnEndedGoalIsDeleted) {
  nodmap::goal_t goal = foxglove::test::goal();
  EXPECT_EQ(goal_scene(goal)["entities"][0]["id"], "goal");
  goal.is_active = 0;
  EXPECT_TRUE(goal_scene(goal)["entities"].empty());
  EXPECT_EQ(goal_scene(goal)["deletions"][0]["id"], "goal");
}

TEST(Scene, AGoalWithAHeadingHasAnArrow) {
  nodmap::goal_t goal = foxglove::test::goal();
  EXPECT_TRUE(goal_scene(goal)["entities"][0]["lines"].empty());
  goal.has_heading = 1;
  goal.heading_rad = 0.5 * std::numbers::pi;
  const Json update = goal_scene(goal);
  const Json& points = update["entities"][0]["lines"][0]["points"];
  EXPECT_NEAR(points[1]["x"].get<double>() - points[0]["x"].get<double>(), 0.0, 1e-12);
  EXPECT_NEAR(points[1]["y"].get<double>() - points[0]["y"].get<double>(), 0.5, 1e-12);
}

TEST(Scene, APathDisappearsWithItsGoal) {
  nodmap::path_t path = foxglove::test::path();
  const Json entity = path_scene(path)["entities"][0];
  ASSERT_EQ(entity["lines"].size(), 2U);
  EXPECT_EQ(entity["lines"][0]["points"].size(), 3U);
  EXPECT_EQ(entity["lines"][0]["points"][2]["y"], 0.5);
  EXPECT_EQ(entity["lines"][1]["points"].size(), 2U);  // the arc
  path.state = nodmap::path_t::NO_GOAL;
  EXPECT_TRUE(path_scene(path)["entities"].empty());
  EXPECT_EQ(path_scene(path)["deletions"][0]["id"], "path");
}

TEST(Scene, EachTrackIsARingAndALineForItsNextSecond) {
  nodmap::tracks_t tracks = foxglove::test::tracks();
  const Json entity = tracks_scene(tracks)["entities"][0];
  EXPECT_EQ(entity["frame_id"], "odom");
  ASSERT_EQ(entity["lines"].size(), 4U);
  for (const Json& p : entity["lines"][0]["points"]) {
    EXPECT_NEAR(std::hypot(p["x"].get<double>() - 2.0, p["y"].get<double>() - 1.0), 0.25, 1e-12);
  }
  EXPECT_EQ(entity["lines"][1]["points"][1]["x"], 1.0);
  EXPECT_EQ(entity["lines"][3]["points"][1]["y"], 0.5);
  EXPECT_LT(entity["lines"][2]["color"]["a"], entity["lines"][0]["color"]["a"]);  // out of sight
  tracks = {};
  EXPECT_TRUE(tracks_scene(tracks)["entities"].empty());
  EXPECT_EQ(tracks_scene(tracks)["deletions"][0]["id"], "tracks");
}

TEST(Scene, AnExplorationShowsFrontiersAndTourUntilItEnds) {
  nodmap::exploration_t exploration = foxglove::test::exploration();
  const Json entity = exploration_scene(exploration)["entities"][0];
  ASSERT_EQ(entity["lines"].size(), 2U);
  EXPECT_EQ(entity["lines"][0]["points"].size(), 2U);  // a line for the frontier
  EXPECT_EQ(entity["lines"][1]["points"].size(), 5U);  // path, then the viewpoints
  EXPECT_EQ(entity["lines"][1]["points"][4]["x"], 5.0);
  EXPECT_EQ(entity["cylinders"].size(), 2U);
  EXPECT_EQ(entity["texts"][1]["text"], "2: 3.5 m2");
  exploration.state = nodmap::exploration_t::HOME;
  EXPECT_TRUE(exploration_scene(exploration)["entities"].empty());
  EXPECT_EQ(exploration_scene(exploration)["deletions"][0]["id"], "exploration");
}

TEST(Scene, ThePoseGraphShowsAcceptedAndRefusedLoops) {
  const Json entity = pose_graph_scene(foxglove::test::pose_graph())["entities"][0];
  ASSERT_EQ(entity["lines"].size(), 3U);
  EXPECT_EQ(entity["lines"][0]["points"].size(), 3U);  // the path over the submaps
  const Json& accepted = entity["lines"][1]["points"];
  ASSERT_EQ(accepted.size(), 2U);
  EXPECT_EQ(accepted[0]["x"], 0.0);
  EXPECT_EQ(accepted[1]["x"], 2.0);
  EXPECT_EQ(entity["lines"][2]["points"].size(), 2U);  // the refused one
}

TEST(Scene, ALoopBetweenMissingSubmapsIsNotDrawn) {
  nodmap::pose_graph_t graph = foxglove::test::pose_graph();
  graph.from_submap[0] = -1;
  graph.to_submap[1] = 3;
  const Json entity = pose_graph_scene(graph)["entities"][0];
  EXPECT_TRUE(entity["lines"][1]["points"].empty());
  EXPECT_TRUE(entity["lines"][2]["points"].empty());
}

TEST(Scene, ThePoseGraphOf6dSlamShowsItsKeyframesInSpace) {
  const Json entity = pose_graph_6d_scene(foxglove::test::pose_graph_6d())["entities"][0];
  EXPECT_EQ(entity["frame_id"], "map_6d");
  EXPECT_EQ(entity["lines"][0]["points"][1]["x"], 3.0);
  EXPECT_EQ(entity["lines"][1]["points"].size(), 2U);
  EXPECT_TRUE(entity["lines"][2]["points"].empty());  // the loop of a missing keyframe
}

}  // namespace scene_views_test
}  // namespace nodmap::foxglove
