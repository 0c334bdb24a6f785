// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <optional>
#include <utility>
#include <vector>

#include "modules/slam2d/test/drawn_world.hpp"
#include "modules/slam2d/test/track.hpp"

namespace nodmap::slam2d {
namespace hidden_view_test {

using geometry::SE2;
using test::Scanner;
using test::track;

// Drives for 1.2 s at 77 scans a second; from the 40th to before the 80th of the 90 scans the
// walls of `somebody` (in base, m) hide part of the view. Returns the last pose while somebody is
// there, and the last pose of the drive.
std::pair<PoseUpdate, PoseUpdate> drive_towards(test::Slam& slam, const test::FloorPlan& somebody) {
  constexpr time::Duration kFast = 13ms;
  Scanner scanner;
  SE2 truth;
  std::pair<PoseUpdate, PoseUpdate> last;
  for (int i = 0; i < 90; ++i) {
    test::FloorPlan plan = test::room();
    const bool is_somebody_there = i >= 40 && i < 80;
    for (const test::Wall& wall : is_somebody_there ? somebody : test::FloorPlan{}) {
      plan.push_back({truth * wall.from, truth * wall.to});
    }
    const auto update = track(slam, scanner.scan(plan, truth, time::Timestamp(kFast * i)), truth);
    EXPECT_TRUE(update);
    last.second = update.value_or(PoseUpdate{});
    last.first = is_somebody_there ? last.second : last.first;
    EXPECT_LT(distance_m(last.second.T_map_base, truth), 0.02) << i;  // twice R34's
    truth = truth * SE2{0.004, 0.0, 0.002};
  }
  return last;
}

// The visible part of the scan determines the pose.
TEST(Slam2d, APersonWhoHidesMostOfTheViewDoesNotMoveThePose) {
  test::Slam slam;
  const auto [hidden, after] = drive_towards(slam, {{{0.5, -1.2}, {0.6, 0.9}}});
  EXPECT_LE(hidden.state, PoseState::kDegraded);
  EXPECT_EQ(after.state, PoseState::kTracking);
}

// Only odometry determines the pose.
TEST(Slam2d, APersonWhoHidesTheWholeViewDoesNotMoveThePose) {
  test::Slam slam;
  const auto [hidden, after] = drive_towards(slam, {{{0.4, -9.0}, {0.5, 9.0}}});
  EXPECT_EQ(hidden.state, PoseState::kOdometry);
  EXPECT_FALSE(hidden.is_keyframe);
  EXPECT_EQ(after.state, PoseState::kTracking);
}

// The wheels do not notice that the robot was carried away. For a second the new view could be that
// of people who pass by, but no longer.
TEST(Slam2d, ARobotThatIsCarriedAwayIsLostAfterASecond) {
  test::Slam slam;
  Scanner scanner;
  const test::FloorPlan elsewhere{{{0.7, -2}, {0.9, 0.5}}, {{0.9, 0.5}, {0.3, 1.5}}};
  std::optional<PoseUpdate> update;
  for (int i = 0; i < 200; ++i) {
    update = track(
        slam, scanner.scan(i < 40 ? test::room() : elsewhere, {}, time::Timestamp(13ms * i)), {});
    ASSERT_TRUE(update);
    EXPECT_TRUE(i < 40 || update->state != PoseState::kTracking) << i;
  }
  EXPECT_EQ(update->state, PoseState::kLost);
}

// Returns the state of the pose of each level scan, two a second, of a nodding laser on a
// stationary robot. In the scans from `from` to before `until` a person right in front of the
// laser hides everything.
std::vector<PoseState> nod_behind_somebody(int from, int until) {
  test::Slam slam;
  Scanner scanner;
  const test::FloorPlan somebody{{{0.4, -9.0}, {0.5, 9.0}}};
  constexpr double kStepRad = geometry::deg_to_rad(1.0);
  std::vector<PoseState> states;
  for (int i = 0; i < 12; ++i) {
    const double direction = i % 2 == 0 ? 1.0 : -1.0;
    double pitch_rad = -0.9 * direction * kStepRad;
    for (int k = 0; k < 4; ++k) {  // of each sweep, from the level one on
      scan::Scan scan = scanner.scan(i >= from && i < until ? somebody : test::room(), {},
                                     time::Timestamp(500ms * i + 13ms * k));
      scan.pitch_first_rad = pitch_rad;
      pitch_rad += direction * kStepRad;
      scan.pitch_last_rad = pitch_rad;
      if (const auto update = track(slam, scan, {})) {
        EXPECT_LT(distance_m(update->T_map_base, {}), 0.02) << i;  // twice R34's
        states.push_back(update->state);
      }
    }
  }
  return states;
}

// The pose follows odometry in the two hidden scans, and is tracked from the third one on.
TEST(Slam2d, WithANoddingLaserOdometryBridgesABrieflyHiddenView) {
  const auto states = nod_behind_somebody(6, 8);
  ASSERT_EQ(states.size(), 12U);
  for (std::size_t i = 0; i < states.size(); ++i) {
    EXPECT_EQ(states[i], i >= 6 && i < 8 ? PoseState::kOdometry : PoseState::kTracking) << i;
  }
}

// After a second the robot may also have been carried away.
TEST(Slam2d, WithANoddingLaserAViewHiddenForASecondMakesTheRobotLost) {
  const auto states = nod_behind_somebody(6, 12);
  ASSERT_EQ(states.size(), 12U);
  EXPECT_EQ(states[7], PoseState::kOdometry);
  EXPECT_EQ(states[8], PoseState::kLost);
}

// The robot is pushed aside by 20 cm in a quarter of a second, or its wheels spin and count half a
// metre too much. The walls then seem to have moved, which might at first be people; after a second
// it is believed.
TEST(Slam2d, ARobotThatIsPushedOrSlipsIsTrackedAgainAfterASecond) {
  for (const auto& [pushed, slipped] :
       {std::pair{SE2{0.0, 0.01, 0.0}, SE2{}}, {SE2{}, SE2{0.025, 0.0, 0.0}}}) {
    test::Slam slam;
    Scanner scanner;
    SE2 truth;
    SE2 odom;
    std::optional<PoseUpdate> update;
    for (int i = 0; i < 170; ++i) {
      const bool is_moved = i >= 40 && i < 60;
      truth = is_moved ? truth * pushed : truth;
      odom = is_moved ? odom * slipped : odom;
      update = track(slam, scanner.scan(test::room(), truth, time::Timestamp(13ms * i)), odom);
      ASSERT_TRUE(update);
      // A pose that is wrong by 5 cm or more is not TRACKING. A match may differ from odometry by 3
      // cm and half of the distance that was counted.
      EXPECT_TRUE(distance_m(update->T_map_base, truth) < 0.05 ||
                  update->state != PoseState::kTracking)
          << i;
    }
    EXPECT_EQ(update->state, PoseState::kTracking);
    EXPECT_LT(distance_m(update->T_map_base, truth), 0.02);  // twice R34's
  }
}

}  // namespace hidden_view_test
}  // namespace nodmap::slam2d
