// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/surroundings/seen_directions.hpp"

#include <gtest/gtest.h>

#include "common/geometry/angle.hpp"

namespace nodmap::navigator {
namespace seen_directions_test {

using geometry::deg_to_rad;

TEST(SeenDirections, ADirectionIsSeenAfterTwoSweeps) {
  SeenDirections view({.view_half_rad = deg_to_rad(70), .sweeps_to_trust = 2});
  view.update(0.0, 10);
  EXPECT_FALSE(view.is_seen(0.0));
  view.update(0.0, 11);
  EXPECT_FALSE(view.is_seen(0.0));
  view.update(0.0, 12);
  EXPECT_TRUE(view.is_seen(0.0));
  EXPECT_TRUE(view.is_seen(deg_to_rad(-69)));
  EXPECT_FALSE(view.is_seen(deg_to_rad(80)));
}

TEST(SeenDirections, AfterAShortGapOnlyDirectionsSeenForTwoSweepsBeforeItCountAsSeen) {
  SeenDirections view({.view_half_rad = deg_to_rad(70), .sweeps_to_trust = 2});
  view.update(0.0, 0);
  view.update(0.0, 1);
  view.update(deg_to_rad(40), 2);
  view.forget_unseen();
  view.update(deg_to_rad(40), 3);
  EXPECT_TRUE(view.is_seen(deg_to_rad(-40)));  // compass 0: seen for two sweeps before the gap
  EXPECT_FALSE(view.is_seen(deg_to_rad(40)));  // compass 80: in view only just before it
  view.update(deg_to_rad(40), 5);
  EXPECT_TRUE(view.is_seen(deg_to_rad(40)));
}

TEST(SeenDirections, ARotationBringsNewDirectionsAndForgetsOldOnes) {
  SeenDirections view({.view_half_rad = deg_to_rad(70), .sweeps_to_trust = 2});
  view.update(0.0, 0);
  view.update(0.0, 2);
  view.update(deg_to_rad(100), 2);
  EXPECT_FALSE(view.is_seen(0.0));             // compass 100: new
  EXPECT_TRUE(view.is_seen(deg_to_rad(-60)));  // compass 40: seen all along
  view.update(0.0, 2);
  EXPECT_FALSE(view.is_seen(deg_to_rad(-60)));  // it was out of view in between
  view.update(0.0, 0);                          // the servo driver has restarted
  EXPECT_FALSE(view.is_seen(deg_to_rad(40)));
  view.update(0.0, 2);
  EXPECT_TRUE(view.is_seen(deg_to_rad(40)));
}

}  // namespace seen_directions_test
}  // namespace nodmap::navigator
