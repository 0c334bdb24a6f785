// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/corrected_poses.hpp"

#include <gtest/gtest.h>

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
  std::vector<PoseUpdate> sweeps;
  for (int i = 0; i < 6; ++i) {
    sweeps.push_back(tracked(i));
    poses.add(sweeps.back().T_map_base);
  }
  const std::vector<CorrectedPoses::Correction> corrections{{1, at(1.0, 0.0)}, {4, at(4.0, 0.3)}};
  poses.move(corrections);
  const std::vector<SE3> moved = poses.trajectory(sweeps);
  const double expected_y[] = {0.0, 0.0, 0.1, 0.2, 0.3, 0.3};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(moved[i].translation().x(), static_cast<double>(i), 1e-12) << i;
    EXPECT_NEAR(moved[i].translation().y(), expected_y[i], 1e-12) << i;
  }
}

// After two moves that cancel out, the poses are as before.
TEST(CorrectedPoses, AMoveAndItsInverseRestoreThePoses) {
  CorrectedPoses poses;
  std::vector<PoseUpdate> sweeps;
  for (int i = 0; i < 4; ++i) {
    sweeps.push_back(tracked(i));
    poses.add(sweeps.back().T_map_base);
  }
  SE3 rotated = at(0.0, 1.0);
  rotated.linear() = geometry::rotation_of({0.0, 0.0, 0.3});
  poses.move(std::vector<CorrectedPoses::Correction>{{0, rotated}, {3, rotated * at(3.0, 0.0)}});
  EXPECT_GT(poses.trajectory(sweeps)[2].translation().y(), 1.5);  // 1 + 2 sin 0.3
  poses.move(std::vector<CorrectedPoses::Correction>{{0, at(0.0, 0.0)}, {3, at(3.0, 0.0)}});
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(poses.trajectory(sweeps)[i].isApprox(sweeps[i].T_map_base, 1e-9)) << i;
  }
}

}  // namespace corrected_poses_test
}  // namespace nodmap::slam6d
