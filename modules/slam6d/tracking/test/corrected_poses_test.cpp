// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/corrected_poses.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace nodmap::slam6d {
namespace corrected_poses_test {

using geometry::SE3;

SE3 at(double x, double y) {
  SE3 T = SE3::Identity();
  T.translation() = Eigen::Vector3d(x, y, 0.0);
  return T;
}

PoseUpdate tracked(double x) {
  return {.T_odom_base = at(x, 0.0), .T_map_base = at(x, 0.0), .keyframe = KeyframeReason::kFirst};
}

TEST(CorrectedPoses, CorrectionsAreInterpolatedBetweenTwoKeyframes) {
  CorrectedPoses poses;
  for (int i = 0; i < 6; ++i) {
    poses.add(tracked(i));
  }
  const std::vector<CorrectedPoses::Correction> corrections{{1, at(1.0, 0.0)}, {4, at(4.0, 0.3)}};
  poses.move(corrections);
  const std::vector<SE3> moved = poses.trajectory();
  const double expected_y[] = {0.0, 0.0, 0.1, 0.2, 0.3, 0.3};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(moved[i].translation().x(), static_cast<double>(i), 1e-12) << i;
    EXPECT_NEAR(moved[i].translation().y(), expected_y[i], 1e-12) << i;
    EXPECT_EQ(poses.sweeps()[i].T_map_base_online.translation().y(), 0.0) << i;
  }
}

// The base driver restarts between the second and the third sweep, while the robot rolls on by 0.3
// m. Only the last sweep shows it.
TEST(CorrectedPoses, WhatOdometryMissedInARestartMovesNoSweepBeforeIt) {
  CorrectedPoses poses;
  poses.add(tracked(0.0));
  poses.add({.T_odom_base = at(1.0, 0.0), .T_map_base = at(1.0, 0.0)});
  poses.add({.T_first_odom = at(1.0, 0.0), .T_map_base = at(1.0, 0.0)});
  PoseUpdate last = tracked(1.0);
  last.T_first_odom = at(1.0, 0.0);
  last.T_map_base = at(2.3, 0.0);
  poses.add(last);
  const double expected_x[] = {0.0, 1.0, 1.3, 2.3};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(poses.trajectory()[i].translation().x(), expected_x[i], 1e-12) << i;
  }
}

// After two moves that cancel out, the poses are as before.
TEST(CorrectedPoses, AMoveAndItsInverseRestoreThePoses) {
  CorrectedPoses poses;
  for (int i = 0; i < 4; ++i) {
    poses.add(tracked(i));
  }
  SE3 rotated = at(0.0, 1.0);
  rotated.linear() = geometry::rotation_of({0.0, 0.0, 0.3});
  poses.move(std::vector<CorrectedPoses::Correction>{{0, rotated}, {3, rotated * at(3.0, 0.0)}});
  EXPECT_GT(poses.trajectory()[2].translation().y(), 1.5);  // 1 + 2 sin 0.3
  poses.move(std::vector<CorrectedPoses::Correction>{{0, at(0.0, 0.0)}, {3, at(3.0, 0.0)}});
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(poses.trajectory()[i].isApprox(tracked(static_cast<double>(i)).T_map_base, 1e-9));
  }
}

// Sweeps 2 and 3 of five were registered 3 m to the side of where odometry is, which proves wrong.
TEST(CorrectedPoses, PosesThatAreTakenBackFollowOdometry) {
  CorrectedPoses poses;
  for (int i = 0; i < 4; ++i) {
    PoseUpdate update = tracked(i);
    update.T_map_base = at(i, i < 2 ? 0.0 : 3.0);
    poses.add(update);
  }
  EXPECT_EQ(poses.take_back(2), 2U);
  poses.place(2, [](const SE3& T_first_base) { return T_first_base; });
  EXPECT_EQ(poses.trajectory()[3].translation().y(), 0.0);
  poses.add(tracked(4));
  for (const SE3& pose : poses.trajectory()) {
    EXPECT_NEAR(pose.translation().y(), 0.0, 1e-12);
  }
}

// Ten times as many sweeps as are kept.
TEST(CorrectedPoses, TheRecordOfALongDriveIsBounded) {
  static_assert(sizeof(SweepPose) <= 450, "so that 131072 take at most 60 MB");
  CorrectedPoses poses(PathParams{.max_sweeps = 1000});
  const std::vector<std::size_t> used{7, 4001, 9999};
  for (int i = 0; i < 10'001; ++i) {
    if (poses.is_full()) {
      poses.drop_sweeps(used);
    }
    poses.add(tracked(i));
    ASSERT_LE(poses.sweeps().size(), 1000U);
  }
  EXPECT_EQ(poses.num_added(), 10'001U);
  for (const std::size_t sweep : used) {
    EXPECT_TRUE(poses.contains(sweep)) << sweep;
  }
  EXPECT_FALSE(poses.contains(4003));
  EXPECT_EQ(poses.sweeps().back().sweep, 10'000U);
  // They are spread evenly: every 16th sweep at least, since 10 001 / 16 are less than 750.
  for (std::size_t i = 1; i < poses.sweeps().size(); ++i) {
    EXPECT_LE(poses.sweeps()[i].sweep - poses.sweeps()[i - 1].sweep, 16U);
  }
}

// The sweeps that are left move as if all were there.
TEST(CorrectedPoses, SweepsThatWereLeftOutDoNotChangeTheOthers) {
  CorrectedPoses all(PathParams{.max_sweeps = 1000});
  CorrectedPoses some(PathParams{.max_sweeps = 10});
  const std::vector<std::size_t> used{1, 31};
  for (int i = 0; i < 40; ++i) {
    PoseUpdate update = tracked(i);
    if (i % 8 == 4) {  // follows odometry, which is 0.1 m off
      update.keyframe.reset();
      update.T_odom_base = at(i, 0.1);
    }
    if (some.is_full()) {
      some.drop_sweeps(used);
    }
    all.add(update);
    some.add(update);
  }
  ASSERT_LT(some.sweeps().size(), 11U);
  const std::vector<CorrectedPoses::Correction> corrections{{1, at(1.0, 0.5)}, {31, at(31.0, 0.0)}};
  all.move(corrections);
  some.move(corrections);
  for (const SweepPose& pose : some.sweeps()) {
    EXPECT_TRUE(pose.T_map_base.isApprox(all.pose_of(pose.sweep), 1e-12)) << pose.sweep;
  }
}

}  // namespace corrected_poses_test
}  // namespace nodmap::slam6d
