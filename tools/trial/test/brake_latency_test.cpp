// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/brake_latency.hpp"

#include <gtest/gtest.h>

namespace nodmap::trial {
namespace {

// At 1 m/s with sweeps of 0.3 s the zone is 0.65 + 1/3 + 0.15 m from the front.
constexpr double kEndM = 0.225 + 0.65 + 1.0 / 3.0 + 0.15;

class BrakeLatencyTest : public ::testing::Test {
 protected:
  BrakeLatencyMonitor monitor_{StoppingZone{}};

  void update(std::int64_t time_us, const Eigen::Vector2d& position, double speed_mps = 1.0) {
    monitor_.update({time_us, {}, speed_mps, 0.3, {sim::ActorState{position, 0.1, 1.0}}});
  }
};

TEST_F(BrakeLatencyTest, FromTheFirstTouchToTheFirstDriveThatBrakes) {
  update(1000, {kEndM + 0.1 + 0.001, 0.0});  // not yet
  update(2000, {kEndM + 0.1 - 0.001, 0.0});
  monitor_.add_drive_command(3000, 0.95);  // less than 10 % slower
  monitor_.add_drive_command(5000, 0.5);
  ASSERT_EQ(monitor_.events().size(), 1U);
  EXPECT_EQ(monitor_.events()[0].started_us, 2000);
  EXPECT_EQ(monitor_.events()[0].answered_us, 5000);
}

TEST_F(BrakeLatencyTest, TheZoneIsAsWideAsTheBody) {
  update(1000, {1.0, 0.165 + 0.1 + 0.001});
  EXPECT_TRUE(monitor_.events().empty());
  update(2000, {1.0, 0.165 + 0.1 - 0.001});
  EXPECT_EQ(monitor_.events().size(), 1U);
}

TEST_F(BrakeLatencyTest, AnObstacleBesideTheBodyIsNotInTheZone) {
  update(1000, {0.225 - 0.1 - 0.001, 0.0});
  EXPECT_TRUE(monitor_.events().empty());
}

TEST_F(BrakeLatencyTest, AnObstacleThatLeavesTheZoneUnansweredWasEvaded) {
  update(1000, {1.0, 0.0});
  update(2000, {1.0, 1.0});
  monitor_.add_drive_command(3000, 0.0);
  EXPECT_TRUE(monitor_.events().empty());
  EXPECT_EQ(monitor_.num_evaded(), 1);
}

TEST_F(BrakeLatencyTest, AnEventThatIsNeverAnsweredIsKept) {
  update(1000, {1.0, 0.0});
  ASSERT_EQ(monitor_.events().size(), 1U);
  EXPECT_FALSE(monitor_.events()[0].answered_us);
}

TEST_F(BrakeLatencyTest, NothingIsMeasuredForASlowRobot) {
  update(1000, {0.4, 0.0}, 0.29);
  EXPECT_TRUE(monitor_.events().empty());
}

}  // namespace
}  // namespace nodmap::trial
