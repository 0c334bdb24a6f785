// SPDX-License-Identifier: BSD-3-Clause
#include "sim/truth_message.hpp"

#include <gtest/gtest.h>

#include "common/node/messages.hpp"

namespace nodmap::sim {
namespace truth_message_test {

TEST(TruthMessage, ContainsPoseAndActors) {
  GroundTruth truth;
  // Three quarters of a turn: a quaternion with w < 0 describes it as well.
  truth.T_world_base = geometry::to_se3({1.0, -2.0, 1.5 * geometry::kPi});
  truth.contacts.collisions = 3;
  truth.contacts.bumps = 2;
  truth.actors = {{.position = {4.0, 5.0}, .radius_m = 0.25, .height_m = 1.75},
                  {.position = {-6.0, 7.0}, .radius_m = 0.2, .height_m = 1.2}};
  const nodmap::truth_t message = write_truth(truth, time::from_utime(42));
  EXPECT_EQ(message.utime, 42);
  const auto T_world_base = node::read_pose(message.position_m, message.orientation);
  ASSERT_TRUE(T_world_base);
  EXPECT_TRUE(T_world_base->isApprox(truth.T_world_base, 1e-12));  // rounding
  EXPECT_GE(message.orientation[0], 0.0);
  EXPECT_EQ(message.collisions, 3);
  EXPECT_EQ(message.bumps, 2);
  ASSERT_EQ(message.num_actors, 2);
  EXPECT_EQ(message.actor_position_m[1], (std::vector<double>{-6.0, 7.0}));
  EXPECT_EQ(message.actor_radius_m, (std::vector<double>{0.25, 0.2}));
  EXPECT_EQ(message.actor_height_m, (std::vector<double>{1.75, 1.2}));
}

}  // namespace truth_message_test
}  // namespace nodmap::sim
