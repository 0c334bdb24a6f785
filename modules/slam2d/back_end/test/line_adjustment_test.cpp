// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/line_adjustment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "modules/slam2d/back_end/submap_chain.hpp"
#include "modules/slam2d/back_end/wheel_errors.hpp"
#include "modules/slam2d/test/drawn_world.hpp"

namespace nodmap::slam2d {
namespace line_adjustment_test {

using geometry::deg_to_rad;
using geometry::SE2;

// Twenty scans 0.3 m apart, with a heading error that grows to 0.3 degrees within the first three
// metres, where a map begins, and stays from there on. As in the map of a nodding laser: each step
// is right to within a few hundredths of a degree.
std::vector<Keyframe> bent_drive(const test::FloorPlan& plan) {
  test::Scanner scanner;
  OrientedPointExtractor extractor;
  std::vector<Keyframe> keyframes;
  SE2 T_map_base;
  for (int k = 0; k < 20; ++k) {
    Keyframe keyframe;
    keyframe.T_odom_base = {0.3 * k, 0.0, 0.0};
    keyframe.T_map_base = T_map_base;
    set_points(keyframe, extractor.extract(scanner.scan(plan, keyframe.T_odom_base), {}));
    keyframes.push_back(keyframe);
    T_map_base = T_map_base * SE2{0.3, 0.0, k < 10 ? deg_to_rad(0.03) : 0.0};
  }
  return keyframes;
}

double worst_heading_rad(const std::vector<SE2>& poses) {
  double worst_rad = 0.0;
  for (const SE2& pose : poses) {
    worst_rad = std::max(worst_rad, std::abs(pose.yaw));
  }
  return worst_rad;
}

// A scan of the corridor tells its heading to 0.03 degrees, as far as the walls ahead are known.
TEST(LineAdjustment, TheBeginningOfACorridorBecomesStraight) {
  const std::vector<SE2> poses =
      adjusted_to_lines(bent_drive(test::corridor_with_doors()), MapParams{});
  ASSERT_EQ(poses.size(), 20U);
  EXPECT_LT(worst_heading_rad(poses), deg_to_rad(0.09));
  for (std::size_t k = 0; k < poses.size(); ++k) {
    EXPECT_NEAR(poses[k].x, 0.3 * static_cast<double>(k), 0.02) << k;
    // What the heading may be off at the end of the moment arm, and a scan's noise.
    EXPECT_NEAR(poses[k].y, 0.0, 0.012) << k;
  }
}

// No line tells how far the robot has moved along the corridor: its steps do.
TEST(LineAdjustment, AlongAnEndlessCorridorThePosesFollowTheSteps) {
  const std::vector<SE2> poses = adjusted_to_lines(bent_drive(test::corridor()), MapParams{});
  EXPECT_LT(worst_heading_rad(poses), deg_to_rad(0.09));
  for (std::size_t k = 0; k < poses.size(); ++k) {
    // Noise in the direction of short lines: measured 7 mm, and 45 mm if steps are held as loosely
    // as by odometry.
    EXPECT_NEAR(poses[k].x, 0.3 * static_cast<double>(k), 0.01) << k;
  }
}

TEST(LineAdjustment, OneKeyframeStaysAndNoneIsNone) {
  std::vector<Keyframe> keyframes = bent_drive(test::corridor_with_doors());
  keyframes[5].T_map_base = {1.0, 2.0, 3.0};
  const std::vector<SE2> one = adjusted_to_lines(std::span(keyframes).subspan(5, 1), MapParams{});
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].x, 1.0);
  EXPECT_EQ(one[0].y, 2.0);
  EXPECT_EQ(one[0].yaw, 3.0);
  EXPECT_TRUE(adjusted_to_lines({}, MapParams{}).empty());
}

// Without points only the steps are left, and they agree.
TEST(LineAdjustment, KeyframesWithoutPointsStay) {
  std::vector<Keyframe> keyframes = bent_drive(test::corridor());
  for (Keyframe& keyframe : keyframes) {
    set_points(keyframe, {});
  }
  const std::vector<SE2> poses = adjusted_to_lines(keyframes, MapParams{});
  for (std::size_t k = 0; k < poses.size(); ++k) {
    EXPECT_LT(distance_m(poses[k], keyframes[k].T_map_base), 1e-9) << k;
  }
}

// The chain of that drive, begun anew at keyframe `anew`.
SubmapChain chain_of(const std::vector<Keyframe>& keyframes, std::size_t anew,
                     const Eigen::Vector3d& sigmas = {3.0, 3.0, 0.5}) {
  SubmapChain chain({}, {});
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    if (k == anew) {
      chain.begin_anew(sigmas);
    }
    const SE2 T_local_keyframe =
        chain.has_local() ? chain.local().T_map_submap.inverse() * keyframes[k].T_map_base : SE2{};
    (void)chain.add(keyframes[k], T_local_keyframe, 1e5 * Eigen::Matrix3d::Identity());
  }
  return chain;
}

TEST(LineAdjustment, TheChainIsStraightAndItsStepsAreSurer) {
  const std::vector<Keyframe> keyframes = bent_drive(test::corridor_with_doors());
  SubmapChain chain = chain_of(keyframes, keyframes.size());
  const Eigen::Matrix3d before = chain.steps()[3].information;
  EXPECT_TRUE(chain.straighten_beginning());
  EXPECT_LT(std::abs(chain.keyframes().back().T_map_base.yaw), deg_to_rad(0.09));
  for (std::size_t k = 0; k + 1 < keyframes.size(); ++k) {
    const SE2 step =
        chain.keyframes()[k].T_map_base.inverse() * chain.keyframes()[k + 1].T_map_base;
    EXPECT_LT(distance_m(chain.steps()[k].T_from_to, step), 1e-12) << k;
    EXPECT_LT(
        distance_m(chain.submaps()[0].pose_of(k + 1),
                   chain.keyframes()[0].T_map_base.inverse() * chain.keyframes()[k + 1].T_map_base),
        1e-9);
  }
  EXPECT_GT(chain.steps()[3].information(2, 2), before(2, 2));
  // Once is enough: a second time the steps would count as surer again.
  EXPECT_FALSE(chain.straighten_beginning());
}

// The robot was lost: where it is since then is for loops to tell.
TEST(LineAdjustment, OnlyThePartBeforeTheRobotWasLostIsAdjusted) {
  const std::vector<Keyframe> keyframes = bent_drive(test::corridor_with_doors());
  SubmapChain chain = chain_of(keyframes, 8);
  EXPECT_TRUE(chain.straighten_beginning());
  EXPECT_GT(distance_m(chain.keyframes()[7].T_map_base, keyframes[7].T_map_base), 1e-4);
  for (std::size_t k = 8; k < keyframes.size(); ++k) {
    EXPECT_LT(distance_m(chain.keyframes()[k].T_map_base, keyframes[k].T_map_base), 1e-12) << k;
  }
  EXPECT_DOUBLE_EQ(chain.steps()[7].information(2, 2), 1.0 / (0.5 * 0.5));
}

// A step that is a little less certain than odometry, as one over dropped keyframes may be, is not
// interrupted; ten times its difference to odometry would be negative. A map with such a step could
// not be read again.
TEST(LineAdjustment, AStepThatIsLessCertainThanOdometryStaysAsCertain) {
  const std::vector<Keyframe> keyframes = bent_drive(test::corridor_with_doors());
  const SE2 step = keyframes[7].T_odom_base.inverse() * keyframes[8].T_odom_base;
  const Eigen::Vector3d odometry = odometry_information(step).diagonal();
  SubmapChain chain = chain_of(keyframes, 8, (0.7 * odometry).cwiseInverse().cwiseSqrt());
  const Eigen::Matrix3d before = chain.steps()[7].information;
  EXPECT_TRUE(chain.straighten_beginning());
  EXPECT_GT(distance_m(chain.keyframes()[8].T_map_base, keyframes[8].T_map_base), 1e-4);
  EXPECT_EQ(chain.steps()[7].information, before);
  for (const registration::PoseEdge2d& edge : chain.steps()) {
    EXPECT_EQ(edge.information.llt().info(), Eigen::Success) << edge.to;
  }
}

}  // namespace line_adjustment_test
}  // namespace nodmap::slam2d
