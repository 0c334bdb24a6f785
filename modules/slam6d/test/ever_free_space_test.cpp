// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/ever_free_space.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "modules/slam6d/test/hall.hpp"

namespace nodmap::slam6d {
namespace ever_free_space_test {

// Beside the robot's way, as tall as a child.
constexpr float kHeightM = 1.2F;

Room hall_with_somebody() {
  Room room = Room::hall();
  room.boxes = {
      {Eigen::Vector3d(1.4, 0.3, 0.0), Eigen::Vector3d(1.8, 0.7, static_cast<double>(kHeightM))}};
  return room;
}

// Of a keyframe's points, those that the box and its surroundings of 5 cm hold.
struct Points {
  std::vector<Eigen::Vector3f> of_box;
  std::vector<Eigen::Vector3f> others;
};

Points points_of(const Keyframe& keyframe) {
  Points points;
  for (const Eigen::Vector3f& p : keyframe.cloud->points) {
    const Eigen::Vector3f p_map = (keyframe.T_map_base * p.cast<double>()).cast<float>();
    const bool is_of_box = p_map.x() > 1.35F && p_map.x() < 1.85F && p_map.y() > 0.25F &&
                           p_map.y() < 0.75F && p_map.z() > 0.25F && p_map.z() < kHeightM + 0.05F;
    (is_of_box ? points.of_box : points.others).push_back(p_map);
  }
  return points;
}

double share_in(const EverFreeSpace& space, const std::vector<Eigen::Vector3f>& points) {
  const auto count =
      std::ranges::count_if(points, [&](const Eigen::Vector3f& p) { return space.contains(p); });
  return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, points.size()));
}

// One keyframe of seven sees somebody where the others see through.
TEST(EverFreeSpace, HoldsWhoWasSeenOnceAndNoWall) {
  TestMap map(Room::hall(), along_hall());
  Keyframe& visited = map.keyframes[2];
  visited.cloud =
      std::make_shared<const SweepCloud>(cloud_at(hall_with_somebody(), visited.T_map_base, 77));
  const EverFreeSpace space({}, map.keyframes);
  const Points points = points_of(visited);
  ASSERT_GT(points.of_box.size(), 20U);
  EXPECT_GT(share_in(space, points.of_box), 0.9);
  EXPECT_LT(share_in(space, points.others), 0.005);  // R49: static kept 99.5 %
}

TEST(EverFreeSpace, WhatAllKeyframesSeeStays) {
  const TestMap map(hall_with_somebody(), along_hall());
  const EverFreeSpace space({}, map.keyframes);
  for (const Keyframe& keyframe : map.keyframes) {
    EXPECT_LT(share_in(space, points_of(keyframe).others), 0.005);
    EXPECT_EQ(share_in(space, points_of(keyframe).of_box), 0.0);
  }
}

TEST(EverFreeSpace, WithoutKeyframesThereIsNone) {
  const EverFreeSpace space({}, {});
  EXPECT_FALSE(space.contains({0.0F, 0.0F, 0.0F}));
  EXPECT_FALSE(space.contains({1e9F, 0.0F, 0.0F}));
}

}  // namespace ever_free_space_test
}  // namespace nodmap::slam6d
