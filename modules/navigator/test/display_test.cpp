// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/display.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "modules/navigator/people/test/walking_scene.hpp"
#include "modules/navigator/test/navigator_node.hpp"

namespace nodmap::navigator {
namespace display_test {

// A robot that is given goals ahead of it.
class DisplayTest : public test::NavigatorNodeScans {
 protected:
  void give_goal(double x_m, std::int64_t utime, bool is_active = true) {
    nodmap::goal_t goal{};
    goal.utime = utime;
    goal.is_active = static_cast<std::int8_t>(is_active);
    goal.tolerance_m = 0.2;
    goal.position_m[0] = x_m;
    bus_.deliver("GOAL", goal);
  }
  void stop(bool is_stopped) {
    nodmap::stop_t stop{};
    stop.is_stopped = static_cast<std::int8_t>(is_stopped);
    bus_.deliver("STOP", stop);
  }
  void run_scans(int number) {
    for (int i = 0; i < number; ++i) {
      tick_with_scan();
    }
  }
};

constexpr int kUntilPlanned = 150;  // two sweeps of 0.35 s, and more

TEST_F(DisplayTest, ThePathToAGoalIsPublishedUntilThereIsNone) {
  give_goal(3.0, 77);
  run_scans(kUntilPlanned);
  const auto path = bus_.last<nodmap::path_t>("PATH");
  EXPECT_EQ(path.state, nodmap::path_t::PLANNED);
  EXPECT_EQ(path.goal_utime, 77);
  EXPECT_EQ(navigation().goal_utime, 77);
  ASSERT_GT(path.num_points, 10);
  // The path begins at the robot and ends in the nearest goal cell; these are the cells within 0.7
  // tolerances.
  EXPECT_NEAR(path.x_m.front(), 0.0, 0.1);
  EXPECT_NEAR(path.x_m.back(), 3.0, 0.2);
  EXPECT_NEAR(path.y_m.back(), 0.0, 0.2);
  ASSERT_EQ(path.num_arc_points, 9);
  EXPECT_EQ(path.arc_x_m.front(), 0.0);
  give_goal(3.0, 78, false);
  tick_with_scan();
  tick();
  EXPECT_EQ(bus_.last<nodmap::path_t>("PATH").state, nodmap::path_t::NO_GOAL);
  EXPECT_EQ(bus_.last<nodmap::path_t>("PATH").goal_utime, 0);
  EXPECT_EQ(navigation().goal_utime, 0);
}

// During a STOP nothing is planned: the path to the first goal must not be published as one to the
// second.
TEST_F(DisplayTest, AGoalGivenDuringAStopHasNoPathYet) {
  give_goal(3.0, 77);
  run_scans(kUntilPlanned);
  ASSERT_EQ(bus_.last<nodmap::path_t>("PATH").goal_utime, 77);
  stop(true);
  give_goal(2.0, 78);
  run_scans(50);
  EXPECT_EQ(navigation().goal_utime, 78);
  EXPECT_EQ(bus_.last<nodmap::path_t>("PATH").goal_utime, 77);
  stop(false);
  run_scans(50);
  EXPECT_EQ(bus_.last<nodmap::path_t>("PATH").goal_utime, 78);
}

// While the head is stationary, the robot waits without planning, and does not halt.
TEST_F(DisplayTest, AGoalGivenWhileItWaitsHasNoPathYet) {
  give_goal(3.0, 77);
  run_scans(kUntilPlanned);
  max_forward_mps_ = 0.0;
  give_goal(2.0, 78);
  run_scans(50);
  ASSERT_FALSE(halts());
  EXPECT_EQ(navigation().goal_utime, 78);
  EXPECT_EQ(bus_.last<nodmap::path_t>("PATH").goal_utime, 77);
  max_forward_mps_ = 1.0;
  run_scans(50);
  EXPECT_EQ(bus_.last<nodmap::path_t>("PATH").goal_utime, 78);
}

// Somebody crosses 2.2 m ahead and leaves the room. The published track is where he is, within the
// tolerances of PeopleTracker's own test; a message without tracks follows when he is gone.
TEST_F(DisplayTest, TracksArePublishedUntilThereIsNobody) {
  std::int64_t num_on_him = 0;
  test::WalkingScene scene{{{}}, 8.0};
  for (double time_s = 0.0; time_s < 15.0; time_s += 0.01) {
    scene.pillars[0].center = {2.2, time_s - 4.0};
    tick_with(scene.scan({}, {}, test::nodding_pitch_rad(time_s)));
    const bool is_in_view = time_s > 3.3 && time_s < 5.0;
    const auto tracks = is_in_view ? bus_.last<nodmap::tracks_t>("TRACKS") : nodmap::tracks_t{};
    if (tracks.num_tracks == 1 && tracks.state[0] == nodmap::tracks_t::WALKS) {
      ++num_on_him;
      EXPECT_NEAR(tracks.position_m[0][0], 2.2, 0.25);
      EXPECT_NEAR(tracks.velocity_mps[0][1], 1.0, 0.5);
    }
  }
  EXPECT_GT(num_on_him, 120);
  EXPECT_EQ(bus_.last<nodmap::tracks_t>("TRACKS").num_tracks, 0);
}

}  // namespace display_test
}  // namespace nodmap::navigator
