// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/model/replaced_keyframe.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <random>
#include <utility>
#include <vector>

#include "modules/slam6d/slam6d.hpp"
#include "modules/slam6d/test/hall.hpp"

namespace nodmap::slam6d {
namespace replaced_keyframe_test {

using geometry::SE3;

// Keyframe 1 has three newer ones at its place, of which the last is in another map; those to the
// side, turned, and far away do not count.
TEST(ReplacedKeyframe, IsTheOldestWithEnoughNewerOnesAtItsPlace) {
  const std::vector<SE3> poses{pose(0.0, 0.0, 0.0), pose(1.0, 0.0, 0.0),  pose(1.0, 0.8, 0.0),
                               pose(1.0, 0.0, 31.), pose(1.7, 0.0, 29.0), pose(9.0, 0.0, 0.0),
                               pose(0.4, 0.0, 0.0), pose(1.0, 0.1, 0.0)};
  std::vector<bool> is_in_map(poses.size(), true);
  const auto one = oldest_replaced_keyframe(poses, is_in_map, 3);
  ASSERT_TRUE(one);
  EXPECT_EQ(one->index, 1U);
  EXPECT_EQ(one->by, 4U);
  EXPECT_FALSE(oldest_replaced_keyframe(poses, is_in_map, 4));
  is_in_map[6] = false;
  EXPECT_FALSE(oldest_replaced_keyframe(poses, is_in_map, 3));
  // The first keyframe holds the frame of the map.
  EXPECT_FALSE(oldest_replaced_keyframe(std::vector(5, SE3::Identity()), {1, 1, 1, 1, 1}, 4));
}

TEST(ReplacedKeyframe, WhatWasItsGoesToTheOneThatReplacesIt) {
  const ReplacedKeyframe replaced{.index = 2, .by = 4};
  const std::vector<std::size_t> expected{0, 1, 3, 2, 3, 4};
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_EQ(replaced.renumbered(k), expected[k]) << k;
  }
}

// A robot that goes up and down Room::hall(), a sweep each 0.55 m, a keyframe each 1.1 m. Odometry
// counts 2 % too much, and its heading drifts.
class PacingRobot {
 public:
  explicit PacingRobot(int max_per_place) : slam({.keyframe = {.max_per_place = max_per_place}}) {}

  void pace(int laps) {
    for (int i = 0; i < laps * 2 * kSteps; ++i) {
      const int step = i % (2 * kSteps);
      const SE3 T_world_base = pose(-2.5 + 0.55 * std::min(step, 2 * kSteps - step), 0.0, 0.0);
      if (!truth.empty()) {
        const SE3 motion = truth.back().inverse() * T_world_base;
        T_odom_base_ =
            T_odom_base_ * pose(1.02 * motion.translation().x(), 0.0, 0.1 * any_(random_));
      }
      SweepCloud cloud = cloud_at(Room::hall(), T_world_base, static_cast<unsigned>(truth.size()));
      cloud.stamp = time::Timestamp(truth.size() * 1s);
      cloud.T_odom_base = T_odom_base_;
      cloud.scans_used = 41;
      (void)slam.add_cloud(std::move(cloud));
      truth.push_back(T_world_base);
    }
  }

  // Of all poses, the first ones aligned.
  [[nodiscard]] double worst_error_m() const {
    const std::vector<SE3> trajectory = slam.trajectory();
    double worst = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const SE3 T_world_base = truth[0] * trajectory[0].inverse() * trajectory[i];
      worst = std::max(worst, (T_world_base.translation() - truth[i].translation()).norm());
    }
    return worst;
  }

  static constexpr int kSteps = 8;                        // from one end to the other
  static constexpr std::size_t kPlaces = 1 + kSteps / 2;  // of keyframes

  Slam6d slam;
  std::vector<SE3> truth;

 private:
  SE3 T_odom_base_ = SE3::Identity();
  std::mt19937 random_{1};
  std::normal_distribution<double> any_;
};

// The mapped volume bounds what is kept, however long the robot paces, and poses stay as exact.
TEST(ReplacedKeyframe, PacingFillsNoMemory) {
  constexpr int kMaxPerPlace = 2;
  PacingRobot robot(kMaxPerPlace);
  robot.pace(4);
  const std::size_t bytes = robot.slam.metrics().keyframe_memory_bytes;
  robot.pace(4);
  // The first keyframe stays, and each place keeps one that has not been replaced often enough.
  EXPECT_LE(robot.slam.keyframes().size(), 1 + PacingRobot::kPlaces * (1 + kMaxPerPlace));
  EXPECT_EQ(robot.slam.keyframes().size() +
                static_cast<std::size_t>(robot.slam.back_end().metrics().keyframes_dropped),
            8U * PacingRobot::kSteps);
  // Sweeps of one place differ by some of their voxels only.
  EXPECT_LT(static_cast<double>(robot.slam.metrics().keyframe_memory_bytes),
            1.05 * static_cast<double>(bytes));
  robot.slam.polish();
  PacingRobot keeps_all(0);
  keeps_all.pace(8);
  keeps_all.slam.polish();
  EXPECT_EQ(keeps_all.slam.keyframes().size(), 8U * PacingRobot::kSteps);
  // 1.25 times what is measured.
  EXPECT_LT(robot.worst_error_m(), 0.0022);
  EXPECT_LT(keeps_all.worst_error_m(), 0.0013);
}

// What is left can be saved and continued: each keyframe is joined to the one before it.
TEST(ReplacedKeyframe, TheGraphStaysWhole) {
  PacingRobot robot(2);
  robot.pace(6);
  const SavedMap saved = robot.slam.save();
  ASSERT_EQ(saved.steps.size(), saved.keyframes.size() - 1);
  for (std::size_t k = 0; k < saved.steps.size(); ++k) {
    const registration::PoseEdge3d& step = saved.steps[k];
    EXPECT_EQ(step.from, k);
    EXPECT_EQ(step.to, k + 1);
    const SE3 error = step.T_from_to.inverse() * saved.keyframes[k].T_map_base.inverse() *
                      saved.keyframes[k + 1].T_map_base;
    EXPECT_LT(error.translation().norm(), 1e-9) << k;  // rounding
  }
  for (const registration::PoseEdge3d& loop : saved.loops) {
    EXPECT_LT(loop.from, loop.to);
    EXPECT_LT(loop.to, saved.keyframes.size());
  }
}

}  // namespace replaced_keyframe_test
}  // namespace nodmap::slam6d
