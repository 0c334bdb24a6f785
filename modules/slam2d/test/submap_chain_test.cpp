// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/submap_chain.hpp"

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

}  // namespace submap_chain_test
}  // namespace nodmap::slam2d
