// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/submap_chain.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

namespace nodmap::slam2d {
namespace submap_chain_test {

using geometry::SE2;

// The robot is lost, and then drives 400 m, of which newer keyframes later replace all but the
// ends. The heading after it was lost is so uncertain that the far end may be anywhere within 200
// m. Yet a saved map is only read if each step determines all directions.
TEST(SubmapChain, ALongStepOverDroppedKeyframesDeterminesAllDirections) {
  SubmapChain chain({.num_keyframes = 4}, {});
  (void)chain.add({}, {}, {});
  chain.begin_anew({3.0, 3.0, 0.5});
  for (int i = 0; i <= 40; ++i) {
    Keyframe keyframe;
    keyframe.T_map_base = {10.0 * i, 0.0, 0.0};
    const SE2 T_local_keyframe =
        chain.has_local() ? chain.local().T_map_submap.inverse() * keyframe.T_map_base : SE2{};
    (void)chain.add(keyframe, T_local_keyframe, 1e4 * Eigen::Matrix3d::Identity());
  }
  while (chain.submaps().size() > 3) {
    (void)chain.drop_submap(1);
  }
  ASSERT_GT(chain.steps()[0].T_from_to.x, 300.0);
  for (const registration::PoseEdge2d& step : chain.steps()) {
    EXPECT_EQ(step.information.llt().info(), Eigen::Success) << step.from;
  }
}

// A straight drive of 24 m with a keyframe every so many metres, each matched as surely.
SubmapChain straight_drive(double step_m) {
  SubmapChain chain({}, {});
  for (double x_m = 0.0; x_m < 24.0; x_m += step_m) {
    Keyframe keyframe;
    keyframe.T_odom_base = {x_m, 0.0, 0.0};
    keyframe.T_map_base = {x_m, 0.0, 0.0};
    const SE2 T_local_keyframe =
        chain.has_local() ? chain.local().T_map_submap.inverse() * keyframe.T_map_base : SE2{};
    (void)chain.add(keyframe, T_local_keyframe, 1e6 * Eigen::Matrix3d::Identity());
  }
  return chain;
}

// Between scans far apart more of the map is new, and less of the error is the same. So the chain
// becomes uncertain with the path, not with the number of scans.
TEST(SubmapChain, SparseKeyframesDoNotMakeTheChainMoreCertain) {
  const auto variance_per_m = [](const SubmapChain& chain) {
    const registration::PoseEdge2d edge = chain.step_to_submap(1);
    return edge.information.inverse()(0, 0) / edge.T_from_to.x;
  };
  // The yaw errors of the steps add to x only beside the path; a step of 1 m counts as three.
  EXPECT_NEAR(variance_per_m(straight_drive(1.0)), variance_per_m(straight_drive(0.31)),
              0.1 * variance_per_m(straight_drive(0.31)));
}

}  // namespace submap_chain_test
}  // namespace nodmap::slam2d
