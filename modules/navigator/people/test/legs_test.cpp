// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/legs.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace nodmap::navigator {
namespace legs_test {

Detection leg(const Eigen::Vector2d& p_odom, std::size_t num_beams = 3) {
  Detection detection;
  detection.p_odom = p_odom;
  detection.radius_m = 0.15;
  detection.lowest_m = 0.1 * static_cast<double>(num_beams);
  detection.highest_m = detection.lowest_m + 0.05;
  detection.num_legs = 1;
  detection.num_beams = num_beams;
  return detection;
}

Detection body(const Eigen::Vector2d& p_odom) {
  Detection detection;
  detection.p_odom = p_odom;
  detection.radius_m = 0.25;
  detection.num_beams = 6;
  return detection;
}

TEST(Legs, TwoLegsAreOnePersonInTheirMiddle) {
  const std::vector<Detection> people = join_legs({leg({1.0, 0.2}, 2), leg({1.3, 0.0}, 4)});
  ASSERT_EQ(people.size(), 1U);
  EXPECT_LT((people[0].p_odom - Eigen::Vector2d(1.15, 0.1)).norm(), 1e-12);
  EXPECT_EQ(people[0].num_legs, 2);
  EXPECT_EQ(people[0].num_beams, 6U);
  EXPECT_GE(people[0].radius_m, 0.25);
  EXPECT_DOUBLE_EQ(people[0].lowest_m, 0.2);
  EXPECT_DOUBLE_EQ(people[0].highest_m, 0.45);
}

// Two people walk one behind the other, and the legs in between are 0.45 m apart.
TEST(Legs, EachLegBelongsToTheNearestOther) {
  const std::vector<Detection> people =
      join_legs({leg({1.0, 0.0}), leg({1.75, 0.0}), leg({1.3, 0.0}), leg({2.0, 0.0})});
  ASSERT_EQ(people.size(), 2U);
  const bool is_near_first = people[0].p_odom.x() < 1.5;
  EXPECT_NEAR(people[is_near_first ? 0 : 1].p_odom.x(), 1.15, 1e-12);
  EXPECT_NEAR(people[is_near_first ? 1 : 0].p_odom.x(), 1.875, 1e-12);
}

TEST(Legs, WhatIsFarAwayOrWiderIsNoSecondLeg) {
  const std::vector<Detection> alone =
      join_legs({leg({1.0, 0.0}), leg({2.0, 0.0}), body({1.2, 0.3})});
  ASSERT_EQ(alone.size(), 3U);
  EXPECT_TRUE(join_legs({}).empty());
}

// Two beams on an edge may be mixed pixels.
TEST(Legs, AFewBeamsAreALegOnlyBesideAnother) {
  EXPECT_TRUE(join_legs({leg({1.0, 0.0}, 2)}).empty());
  EXPECT_TRUE(join_legs({leg({1.0, 0.0}, 2), leg({1.2, 0.0}, 2)}).empty());
  EXPECT_EQ(join_legs({leg({1.0, 0.0}, 2), leg({1.2, 0.0}, 3)}).size(), 1U);
}

}  // namespace legs_test
}  // namespace nodmap::navigator
