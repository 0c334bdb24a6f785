// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/normal_equations.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::registration {
namespace normal_equations_test {

constexpr double kMinInformationRatio = 0.02;
constexpr double kExact = 1e-9;  // rounding of a well scaled 3 x 3 system

// Correspondences with the wall beside the robot, with the wall ahead, or with both. The robot's
// pose differs from the true one by `off` (dx and dy in m, dyaw in rad).
NormalEquations correspondences_with_walls(bool beside, bool ahead, const Eigen::Vector3d& off) {
  NormalEquations equations;
  const auto add = [&](const Eigen::Vector2d& normal, const Eigen::Vector2d& moment_arm) {
    const Eigen::Vector2d moved(off.x() - off.z() * moment_arm.y(),
                                off.y() + off.z() * moment_arm.x());
    equations.add(normal, moment_arm, normal.dot(moved), 1.0);
  };
  for (int i = -10; i <= 10; ++i) {
    if (beside) {
      add({0, -1}, {0.3 * i, 1.0});
    }
    if (ahead) {
      add({-1, 0}, {3.0, 0.2 * i});
    }
  }
  return equations;
}

TEST(NormalEquations, StepLeadsToTheTruePoseWhenAllDirectionsAreDetermined) {
  const Eigen::Vector3d off(0.1, -0.2, 0.05);
  const NormalEquations equations = correspondences_with_walls(true, true, off);
  EXPECT_EQ(equations.solve(kMinInformationRatio).degenerate_directions, 0);
  EXPECT_LT((equations.solve(kMinInformationRatio).step + off).norm(), kExact);
}

TEST(NormalEquations, R37_TheAxisOfACorridorIsDegenerate) {
  const NormalEquations equations = correspondences_with_walls(true, false, {0.4, -0.2, 0.05});
  EXPECT_EQ(equations.solve(kMinInformationRatio).degenerate_directions, 1);
  EXPECT_NEAR(equations.solve(kMinInformationRatio).least_information_ratio, 0.0, kExact);
  const Eigen::Vector3d step = equations.solve(kMinInformationRatio).step;
  EXPECT_NEAR(step.x(), 0.0, kExact);
  EXPECT_NEAR(step.y(), 0.2, kExact);
  EXPECT_NEAR(step.z(), -0.05, kExact);
}

TEST(NormalEquations, TheProjectorKeepsTheDeterminedDirections) {
  const auto in_corridor =
      correspondences_with_walls(true, false, {0, 0, 0}).solve(kMinInformationRatio);
  const Eigen::Vector3d kept = in_corridor.projector * Eigen::Vector3d(0.4, -0.2, 0.05);
  EXPECT_LT((kept - Eigen::Vector3d(0.0, -0.2, 0.05)).norm(), kExact);
  const auto in_room =
      correspondences_with_walls(true, true, {0, 0, 0}).solve(kMinInformationRatio);
  EXPECT_LT((in_room.projector - Eigen::Matrix3d::Identity()).norm(), kExact);
}

TEST(NormalEquations, WithoutCorrespondencesEveryDirectionIsDegenerate) {
  const NormalEquations equations;
  EXPECT_EQ(equations.solve(kMinInformationRatio).degenerate_directions, 3);
  EXPECT_TRUE(equations.solve(kMinInformationRatio).step.isZero(0.0));
  EXPECT_TRUE(equations.solve(kMinInformationRatio).projector.isZero(0.0));
}

}  // namespace normal_equations_test
}  // namespace nodmap::registration
