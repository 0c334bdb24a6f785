// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/brake_watch.hpp"

#include <gtest/gtest.h>

namespace nodmap::trial {
namespace {

// At 1 m/s with sweeps of 0.3 s the way is 0.65 + 1/3 + 0.15 m from the front.
constexpr double kEndM = 0.225 + 0.65 + 1.0 / 3.0 + 0.15;

class BrakeWatchTest : public ::testing::Test {
 protected:
  BrakeWatch watch_{StoppingWay{}};

  void see(std::int64_t time_us, const Eigen::Vector2d& place, double speed_mps = 1.0) {
    watch_.see({time_us, {}, speed_mps, 0.3, {sim::ActorState{place, 0.1, 1.0}}});
  }
};

TEST_F(BrakeWatchTest, FromTheFirstTouchToTheFirstDriveThatBrakes) {
  see(1000, {kEndM + 0.1 + 0.001, 0.0});  // not yet
  see(2000, {kEndM + 0.1 - 0.001, 0.0});
  watch_.hear_drive(3000, 0.95);  // less than 10 % slower
  watch_.hear_drive(5000, 0.5);
  ASSERT_EQ(watch_.events().size(), 1U);
  EXPECT_EQ(watch_.events()[0].began_us, 2000);
  EXPECT_EQ(watch_.events()[0].answered_us, 5000);
}

TEST_F(BrakeWatchTest, TheWayIsAsWideAsTheBody) {
  see(1000, {1.0, 0.165 + 0.1 + 0.001});
  EXPECT_TRUE(watch_.events().empty());
  see(2000, {1.0, 0.165 + 0.1 - 0.001});
  EXPECT_EQ(watch_.events().size(), 1U);
}

TEST_F(BrakeWatchTest, WhatIsBesideTheBodyIsNotInTheWay) {
  see(1000, {0.225 - 0.1 - 0.001, 0.0});
  EXPECT_TRUE(watch_.events().empty());
}

TEST_F(BrakeWatchTest, WhatLeavesTheWayUnansweredWasEvaded) {
  see(1000, {1.0, 0.0});
  see(2000, {1.0, 1.0});
  watch_.hear_drive(3000, 0.0);
  EXPECT_TRUE(watch_.events().empty());
  EXPECT_EQ(watch_.evaded(), 1);
}

TEST_F(BrakeWatchTest, WhatIsNeverAnsweredIsKept) {
  see(1000, {1.0, 0.0});
  ASSERT_EQ(watch_.events().size(), 1U);
  EXPECT_FALSE(watch_.events()[0].answered_us);
}

TEST_F(BrakeWatchTest, ASlowRobotIsNotWatched) {
  see(1000, {0.4, 0.0}, 0.29);
  EXPECT_TRUE(watch_.events().empty());
}

}  // namespace
}  // namespace nodmap::trial
