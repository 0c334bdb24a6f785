// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/normal_equations.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::slam2d {
namespace {

constexpr double kWeakShare = 0.02;
constexpr double kExact = 1e-9;  // a 3 x 3 system of well scaled numbers: rounding only

/// Pairs of points on two walls, one or both, as if the robot stood (dx, dy, dyaw) off.
NormalEquations pairs_with_walls(bool beside, bool ahead, const Eigen::Vector3d& off) {
  NormalEquations equations;
  const auto add = [&](const Eigen::Vector2d& normal, const Eigen::Vector2d& lever) {
    const Eigen::Vector2d moved(off.x() - off.z() * lever.y(), off.y() + off.z() * lever.x());
    equations.add(normal, lever, normal.dot(moved), 1.0);
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

TEST(NormalEquations, StepLeadsBackWhenAllIsSeen) {
  const Eigen::Vector3d off(0.1, -0.2, 0.05);
  const NormalEquations equations = pairs_with_walls(true, true, off);
  EXPECT_EQ(equations.observability(kWeakShare).weak_directions, 0);
  EXPECT_LT((equations.step(kWeakShare) + off).norm(), kExact);
}

TEST(NormalEquations, R37_ACorridorLeavesItsAxisOpen) {
  const NormalEquations equations = pairs_with_walls(true, false, {0.4, -0.2, 0.05});
  EXPECT_EQ(equations.observability(kWeakShare).weak_directions, 1);
  const Eigen::Vector3d step = equations.step(kWeakShare);
  EXPECT_NEAR(step.x(), 0.0, kExact);
  EXPECT_NEAR(step.y(), 0.2, kExact);
  EXPECT_NEAR(step.z(), -0.05, kExact);
}

TEST(NormalEquations, ProjectorKeepsWhatIsObservable) {
  const auto in_corridor = pairs_with_walls(true, false, {0, 0, 0}).observability(kWeakShare);
  const Eigen::Vector3d kept = in_corridor.observable * Eigen::Vector3d(0.4, -0.2, 0.05);
  EXPECT_LT((kept - Eigen::Vector3d(0.0, -0.2, 0.05)).norm(), kExact);
  const auto in_room = pairs_with_walls(true, true, {0, 0, 0}).observability(kWeakShare);
  EXPECT_LT((in_room.observable - Eigen::Matrix3d::Identity()).norm(), kExact);
}

TEST(NormalEquations, NothingIsKnownWithoutPairs) {
  const NormalEquations equations;
  EXPECT_EQ(equations.observability(kWeakShare).weak_directions, 3);
  EXPECT_TRUE(equations.step(kWeakShare).isZero(0.0));
  EXPECT_TRUE(equations.observability(kWeakShare).observable.isZero(0.0));
}

}  // namespace
}  // namespace nodmap::slam2d
