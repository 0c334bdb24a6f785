// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <optional>
#include <utility>
#include <vector>

#include "modules/slam2d/slam2d.hpp"
#include "modules/slam2d/test/drawn_world.hpp"
#include "modules/slam2d/test/track.hpp"

namespace nodmap::slam2d {
namespace hidden_view_test {

using geometry::SE2;
using test::Scanner;
using test::track;

/// Drives for a second at 75 scans a second, half of the time with `somebody` in the way. Returns
/// the last pose while somebody is there, and the last one of all.
std::pair<PoseUpdate, PoseUpdate> drive_towards(Slam2d& slam, const test::FloorPlan& somebody) {
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

// The rest of the scan determines the place.
TEST(Slam2d, SomebodyWhoHidesMostOfTheViewDoesNotMoveThePose) {
  Slam2d slam{Slam2dParams{}};
  const auto [hidden, after] = drive_towards(slam, {{{0.5, -1.2}, {0.6, 0.9}}});
  EXPECT_LE(hidden.quality, PoseQuality::kPartly);
  EXPECT_EQ(after.quality, PoseQuality::kTracked);
}

// Only odometry determines the place.
TEST(Slam2d, SomebodyWhoHidesAllDoesNotMoveThePose) {
  Slam2d slam{Slam2dParams{}};
  const auto [hidden, after] = drive_towards(slam, {{{0.4, -9.0}, {0.5, 9.0}}});
  EXPECT_EQ(hidden.quality, PoseQuality::kOdometry);
  EXPECT_FALSE(hidden.is_keyframe);
  EXPECT_EQ(after.quality, PoseQuality::kTracked);
}

// The wheels do not notice that it was carried, but people would have passed by within a second.
TEST(Slam2d, ACarriedRobotIsLostAfterASecond) {
  Slam2d slam{Slam2dParams{}};
  Scanner scanner;
  const test::FloorPlan elsewhere{{{0.7, -2}, {0.9, 0.5}}, {{0.9, 0.5}, {0.3, 1.5}}};
  std::optional<PoseUpdate> update;
  for (int i = 0; i < 200; ++i) {
    update = track(
        slam, scanner.scan(i < 40 ? test::room() : elsewhere, {}, time::Timestamp(13ms * i)), {});
    ASSERT_TRUE(update);
    EXPECT_TRUE(i < 40 || update->quality != PoseQuality::kTracked) << i;
  }
  EXPECT_EQ(update->quality, PoseQuality::kLost);
}

/// The quality of each level scan of a nodding laser, two a second, on a stationary robot. Somebody
/// right in front of the laser hides everything in the scans from `from` to before `until`.
std::vector<PoseQuality> nod_behind_somebody(int from, int until) {
  Slam2d slam{Slam2dParams{}};
  Scanner scanner;
  const test::FloorPlan somebody{{{0.4, -9.0}, {0.5, 9.0}}};
  constexpr double kStepRad = geometry::deg_to_rad(1.0);
  std::vector<PoseQuality> qualities;
  for (int i = 0; i < 12; ++i) {
    const double direction = i % 2 == 0 ? 1.0 : -1.0;
    double pitch_rad = -0.9 * direction * kStepRad;
    for (int k = 0; k < 2; ++k) {  // of a sweep: up to the level one
      scan::Scan scan = scanner.scan(i >= from && i < until ? somebody : test::room(), {},
                                     time::Timestamp(500ms * i + 13ms * k));
      scan.pitch_first_rad = pitch_rad;
      pitch_rad += direction * kStepRad;
      scan.pitch_last_rad = pitch_rad;
      if (const auto update = track(slam, scan, {})) {
        EXPECT_LT(distance_m(update->T_map_base, {}), 0.02) << i;  // twice R34's
        qualities.push_back(update->quality);
      }
    }
  }
  return qualities;
}

// Until he has passed by, at the third scan, the pose follows odometry.
TEST(Slam2d, WithANodSomebodyWhoHidesAllForAMomentDoesNotMakeItLost) {
  const auto qualities = nod_behind_somebody(6, 8);
  ASSERT_EQ(qualities.size(), 12U);
  for (std::size_t i = 0; i < qualities.size(); ++i) {
    EXPECT_EQ(qualities[i], i >= 6 && i < 8 ? PoseQuality::kOdometry : PoseQuality::kTracked) << i;
  }
}

// The robot may have been carried away.
TEST(Slam2d, WithANodItIsLostWhenTheViewIsHiddenForASecond) {
  const auto qualities = nod_behind_somebody(6, 12);
  ASSERT_EQ(qualities.size(), 12U);
  EXPECT_EQ(qualities[7], PoseQuality::kOdometry);
  EXPECT_EQ(qualities[8], PoseQuality::kLost);
}

// Nobody is there, but the walls seem to have moved, which is believed after a second. Either the
// robot is pushed aside by 20 cm in a quarter of a second, or its wheels spin and count half a
// metre.
TEST(Slam2d, ARobotThatIsPushedOrSlipsIsFoundAgainAfterASecond) {
  for (const auto& [pushed, slipped] :
       {std::pair{SE2{0.0, 0.01, 0.0}, SE2{}}, {SE2{}, SE2{0.025, 0.0, 0.0}}}) {
    Slam2d slam{Slam2dParams{}};
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
      // Until then the pose is not TRACKING. The limit of slip is 3 cm and half of the way that was
      // counted.
      EXPECT_TRUE(distance_m(update->T_map_base, truth) < 0.05 ||
                  update->quality != PoseQuality::kTracked)
          << i;
    }
    EXPECT_EQ(update->quality, PoseQuality::kTracked);
    EXPECT_LT(distance_m(update->T_map_base, truth), 0.02);  // twice R34's
  }
}

}  // namespace hidden_view_test
}  // namespace nodmap::slam2d
