// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/display.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "modules/navigator/people/test/walking_scene.hpp"
#include "modules/navigator/test/navigator_node.hpp"

namespace nodmap::navigator {
namespace display_test {

using test::NavigatorNodeScans;

TEST_F(NavigatorNodeScans, ThePathToAGoalIsPublishedUntilThereIsNone) {
  nodmap::goal_t goal{};
  goal.is_active = true;
  goal.tolerance_m = 0.2;
  goal.position_m[0] = 3.0;
  bus_.deliver("GOAL", goal);
  for (int i = 0; i < 150; ++i) {  // it plans after two sweeps of 0.35 s
    tick_with_scan();
  }
  const auto path = bus_.last<nodmap::path_t>("PATH");
  EXPECT_EQ(path.state, nodmap::path_t::PLANNED);
  ASSERT_GT(path.num_points, 10);
  // The path begins at the robot and ends in the nearest goal cell; these are the cells within 0.7
  // tolerances.
  EXPECT_NEAR(path.x_m.front(), 0.0, 0.1);
  EXPECT_NEAR(path.x_m.back(), 3.0, 0.2);
  EXPECT_NEAR(path.y_m.back(), 0.0, 0.2);
  ASSERT_EQ(path.num_arc_points, 9);
  EXPECT_EQ(path.arc_x_m.front(), 0.0);
  goal.is_active = false;
  bus_.deliver("GOAL", goal);
  tick_with_scan();
  tick();
  EXPECT_EQ(bus_.last<nodmap::path_t>("PATH").state, nodmap::path_t::NO_GOAL);
}

// Somebody crosses 2.2 m ahead and leaves the room. The published track is where he is, within the
// tolerances of PeopleTracker's own test; a message without tracks follows when he is gone.
TEST_F(NavigatorNodeScans, TracksArePublishedUntilThereIsNobody) {
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
