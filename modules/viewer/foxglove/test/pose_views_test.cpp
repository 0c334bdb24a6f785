// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/pose_views.hpp"

#include <gtest/gtest.h>

namespace nodmap::foxglove {
namespace pose_views_test {

TEST(Trail, KeepsPosesThatAreFarEnoughApart) {
  Trail trail("odom", 0.1);
  geometry::SE3 pose = geometry::SE3::Identity();
  EXPECT_TRUE(trail.add(time::from_utime(1), pose));
  pose.translation().x() = 0.09;
  EXPECT_FALSE(trail.add(time::from_utime(2), pose));
  pose.translation().x() = 0.11;
  EXPECT_TRUE(trail.add(time::from_utime(3), pose));
  const Json json = trail.poses_in_frame();
  EXPECT_EQ(json["poses"].size(), 2U);
  EXPECT_EQ(json["timestamp"], time_json(time::from_utime(3)));
}

TEST(Trail, IsPublishedWhenItHasGrownAndNotTooOften) {
  Trail trail("odom", 0.1);
  geometry::SE3 pose = geometry::SE3::Identity();
  trail.add(time::from_utime(0), pose);
  EXPECT_TRUE(trail.take_turn(time::from_utime(0)));
  pose.translation().x() = 1.0;
  trail.add(time::from_utime(10), pose);
  EXPECT_FALSE(trail.take_turn(time::Timestamp(Trail::kPeriod - 1us)));
  EXPECT_TRUE(trail.take_turn(time::Timestamp(Trail::kPeriod)));
  EXPECT_FALSE(trail.take_turn(time::Timestamp(5 * Trail::kPeriod)));
  pose.translation().x() = 2.0;
  trail.add(time::from_utime(20), pose);
  EXPECT_TRUE(trail.take_turn(time::from_utime(20)));  // the clock was set back
}

TEST(Trail, ForgetsTheOldestWhenItIsFull) {
  Trail trail("odom", 0.5);
  geometry::SE3 pose = geometry::SE3::Identity();
  for (std::size_t i = 0; i < Trail::kMaxPoses + 3; ++i) {
    pose.translation().x() = static_cast<double>(i);
    trail.add(time::from_utime(static_cast<std::int64_t>(i)), pose);
  }
  EXPECT_EQ(trail.size(), Trail::kMaxPoses);
  EXPECT_DOUBLE_EQ(trail.poses_in_frame()["poses"][0]["position"]["x"], 3.0);
}

}  // namespace pose_views_test
}  // namespace nodmap::foxglove
