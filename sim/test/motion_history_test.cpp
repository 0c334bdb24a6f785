// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/motion_history.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace nodmap::sim {
namespace motion_history_test {

time::SteadyTime at(time::Duration since_start) {
  return time::SteadyTime(since_start);
}

// Everything changes at constant rates: 1 m/s along x, 2 rad/s about z, the pitch by 3 rad/s.
MotionHistory run(int steps) {
  MotionHistory history;
  for (int i = 0; i <= steps; ++i) {
    const double time_s = 1e-3 * i;
    Step& step = history.add(at(i * 1ms));
    step.position.x() = time_s;
    step.orientation = Eigen::AngleAxisd(2.0 * time_s, Eigen::Vector3d::UnitZ());
    step.pitch = {3.0 * time_s, 3.0};
    step.travel = {4.0 * time_s, 5.0 * time_s};
    step.actors = {{{time_s, 0.0}, 0.25, 1.7, 0}};
  }
  return history;
}

// 300 steps: each place of the ring has been used twice.
TEST(MotionHistory, InterpolatesBetweenTheStepsItKeeps) {
  const MotionHistory history = run(300);
  EXPECT_EQ(history.newest(), at(300ms));
  EXPECT_LE(history.oldest(), at(200ms)) << "100 ms are needed";
  for (time::SteadyTime instant = history.oldest(); instant <= history.newest(); instant += 77us) {
    const double time_s = time::seconds(instant.time_since_epoch());
    const Moment moment = history.at(instant);
    EXPECT_NEAR(moment.T_world_base().translation().x(), time_s, 1e-12);
    // The chord of an arc of 2 mrad: its angle is off by less than the third power of the arc.
    EXPECT_NEAR(geometry::to_se2(moment.T_world_base()).yaw, 2.0 * time_s, 1e-8);
    EXPECT_NEAR(moment.pitch().pitch_rad, 3.0 * time_s, 1e-12);
    EXPECT_NEAR(moment.pitch().rate_rad_s, 3.0, 1e-12);
    EXPECT_NEAR(moment.travel().left_m, 4.0 * time_s, 1e-12);
    EXPECT_NEAR(moment.travel().right_m, 5.0 * time_s, 1e-12);
    EXPECT_NEAR(moment.actors().at(0).position.x(), time_s, 1.001e-3) << "within a step";
  }
}

TEST(MotionHistory, AtTheEndOfAStepItIsThatStep) {
  const MotionHistory history = run(10);
  for (int i = 0; i <= 10; ++i) {
    EXPECT_NEAR(history.at(at(i * 1ms)).travel().left_m, 4e-3 * i, 1e-15) << i;
  }
}

TEST(MotionHistory, OfTheStartItHasOneStep) {
  const MotionHistory history = run(0);
  EXPECT_EQ(history.newest(), at(0ms));
  EXPECT_EQ(history.at(at(0ms)).travel().left_m, 0.0);
}

}  // namespace motion_history_test
}  // namespace nodmap::sim
