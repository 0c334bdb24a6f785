// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/brake_latency.hpp"

#include <gtest/gtest.h>

namespace nodmap::trial {
namespace brake_latency_test {

// At 1 m/s with sweeps of 0.3 s the zone is 0.65 + 1/3 + 0.15 m from the front.
constexpr double kEndM = 0.225 + 0.65 + 1.0 / 3.0 + 0.15;

class BrakeLatencyTest : public ::testing::Test {
 protected:
  // The robot is told to drive 1 m/s.
  BrakeLatencyTest() : BrakeLatencyTest(UndisturbedRun{}) {}
  explicit BrakeLatencyTest(const UndisturbedRun& undisturbed)
      : monitor_(StoppingZone{}, undisturbed) {
    drive(0ms, 1.0);
  }

  BrakeLatencyMonitor monitor_;
  std::int64_t drive_seq_ = 0;

  void drive(time::Duration received, double forward_mps) {
    monitor_.add_drive_command(time::SteadyTime(received), drive_seq_++, forward_mps);
  }

  void update(time::Duration now, const Eigen::Vector2d& position, double speed_mps = 1.0) {
    update_actor(now, {{position, 0.1, 1.0}}, speed_mps);
  }
  void update_actor(time::Duration now, const BrakeLatencyMonitor::Actor& actor,
                    double speed_mps = 1.0) {
    monitor_.update({time::SteadyTime(now), {}, speed_mps, 0.3, {actor}});
  }
};

TEST_F(BrakeLatencyTest, FromTheFirstTouchToTheFirstDriveThatBrakes) {
  update(1ms, {kEndM + 0.1 + 0.001, 0.0});  // not yet
  update(2ms, {kEndM + 0.1 - 0.001, 0.0});
  drive(3ms, 0.95);  // less than 10 % slower
  drive(5ms, 0.5);
  ASSERT_EQ(monitor_.events().size(), 1U);
  EXPECT_EQ(monitor_.events()[0].started, time::SteadyTime(2ms));
  EXPECT_EQ(monitor_.events()[0].answered, time::SteadyTime(5ms));
}

// The wheels still drive 1 m/s, but 0.8 m/s was commanded before the obstacle was there.
TEST_F(BrakeLatencyTest, WhatWasCommandedBeforeIsNoAnswer) {
  drive(1ms, 0.8);
  update(2ms, {1.0, 0.0});
  drive(3ms, 0.8);
  ASSERT_EQ(monitor_.events().size(), 1U);
  EXPECT_FALSE(monitor_.events()[0].answered);
  drive(5ms, 0.7);
  ASSERT_EQ(monitor_.events().size(), 1U);
  EXPECT_EQ(monitor_.events()[0].answered, time::SteadyTime(5ms));
}

TEST_F(BrakeLatencyTest, TheZoneIsAsWideAsTheBody) {
  update(1ms, {1.0, 0.165 + 0.1 + 0.001});
  EXPECT_TRUE(monitor_.events().empty());
  update(2ms, {1.0, 0.165 + 0.1 - 0.001});
  EXPECT_EQ(monitor_.events().size(), 1U);
}

TEST_F(BrakeLatencyTest, TheZoneIsWhatTheRobotsParametersRequire) {
  StoppingZone zone;
  EXPECT_NEAR(zone.length_m(1.0, 0.3), kEndM - 0.225, 1e-12);
  zone.braking = {.deceleration_mps2 = 1.0, .stop_margin_m = 0.2};
  zone.detection.processing_s = 0.1;
  EXPECT_NEAR(zone.length_m(1.0, 0.3), 0.7 + 0.5 + 0.2, 1e-12);
  EXPECT_NEAR(zone.length_m(-1.0, 0.3), 0.2, 1e-12);
}

TEST_F(BrakeLatencyTest, AnObstacleBesideTheBodyIsNotInTheZone) {
  update(1ms, {0.225 - 0.1 - 0.001, 0.0});
  EXPECT_TRUE(monitor_.events().empty());
}

TEST_F(BrakeLatencyTest, AnObstacleThatLeavesTheZoneUnansweredWasEvaded) {
  update(1ms, {1.0, 0.0});
  update(2ms, {1.0, 1.0});
  drive(3ms, 0.0);
  EXPECT_TRUE(monitor_.events().empty());
  EXPECT_EQ(monitor_.num_evaded(), 1);
}

// As when a thin pole passes between the obstacle and the mirror.
TEST_F(BrakeLatencyTest, AnObstacleIsNotNewAgainWhenItWasHiddenForAMoment) {
  const sim::ActorState obstacle{{1.0, 0.0}, 0.1, 1.0};
  update_actor(1ms, {obstacle, true});
  update_actor(2ms, {obstacle, false});
  update_actor(3ms, {obstacle, true});
  drive(200ms, 0.5);
  ASSERT_EQ(monitor_.events().size(), 1U);
  EXPECT_EQ(monitor_.events()[0].started, time::SteadyTime(1ms));
  EXPECT_EQ(monitor_.num_evaded(), 0);
}

TEST_F(BrakeLatencyTest, AnObstacleThatIsHiddenAtFirstCountsFromWhenItIsVisible) {
  const sim::ActorState obstacle{{1.0, 0.0}, 0.1, 1.0};
  update_actor(1ms, {obstacle, false});
  EXPECT_TRUE(monitor_.events().empty());
  update_actor(2ms, {obstacle, true});
  ASSERT_EQ(monitor_.events().size(), 1U);
  EXPECT_EQ(monitor_.events()[0].started, time::SteadyTime(2ms));
}

// At 0.97 m/s the zone is 4 cm shorter, so that the obstacle at its end would be outside.
TEST_F(BrakeLatencyTest, AnObstacleIsNotNewAgainWhenTheRobotSlowsDownALittle) {
  update(1ms, {kEndM, 0.0});
  update(2ms, {kEndM + 0.09, 0.0}, 0.97);
  update(3ms, {kEndM, 0.0});
  drive(5ms, 0.5);
  ASSERT_EQ(monitor_.events().size(), 1U);
  EXPECT_EQ(monitor_.events()[0].started, time::SteadyTime(1ms));
  EXPECT_EQ(monitor_.num_evaded(), 0);
}

TEST_F(BrakeLatencyTest, AnEventThatIsNeverAnsweredIsKept) {
  update(1ms, {1.0, 0.0});
  ASSERT_EQ(monitor_.events().size(), 1U);
  EXPECT_FALSE(monitor_.events()[0].answered);
}

TEST_F(BrakeLatencyTest, NothingIsMeasuredForASlowRobot) {
  update(1ms, {0.4, 0.0}, 0.29);
  EXPECT_TRUE(monitor_.events().empty());
}

// Without the obstacle the DRIVEs 0 to 3 are 1 m/s, 0.8 m/s for a bend, 1 m/s, and 0.2 m/s at a
// narrow place.
class BrakeLatencyBesideUndisturbedRunTest : public BrakeLatencyTest {
 protected:
  BrakeLatencyBesideUndisturbedRunTest()
      : BrakeLatencyTest({.actor = 0, .drives_mps = {{0, 1.0}, {1, 0.8}, {2, 1.0}, {3, 0.2}}}) {}
};

TEST_F(BrakeLatencyBesideUndisturbedRunTest, ASlowingDownThatWouldHaveHappenedAnywayIsNoAnswer) {
  update(1ms, {1.0, 0.0});
  drive(5ms, 0.8);  // for the bend
  ASSERT_EQ(monitor_.events().size(), 1U);
  EXPECT_FALSE(monitor_.events()[0].answered);
  drive(300ms, 0.8);
  EXPECT_EQ(monitor_.events()[0].answered, time::SteadyTime(300ms));
}

TEST_F(BrakeLatencyBesideUndisturbedRunTest, BrakingHarderThanForTheBendIsAnAnswer) {
  update(1ms, {1.0, 0.0});
  drive(5ms, 0.5);
  ASSERT_EQ(monitor_.events().size(), 1U);
  EXPECT_EQ(monitor_.events()[0].answered, time::SteadyTime(5ms));
}

TEST_F(BrakeLatencyBesideUndisturbedRunTest,
       WhereTheRobotWouldHaveBeenSlowAnywayNothingIsMeasured) {
  update(1ms, {1.0, 0.0});
  drive(5ms, 0.8);
  drive(10ms, 1.0);
  drive(15ms, 0.0);  // at the narrow place
  drive(20ms, 0.0);
  EXPECT_TRUE(monitor_.events().empty());
  EXPECT_EQ(monitor_.num_masked(), 1);
  EXPECT_EQ(monitor_.num_evaded(), 0);
}

// It should have braked long before the narrow place.
TEST_F(BrakeLatencyBesideUndisturbedRunTest, ALateAnswerIsNotMasked) {
  update(1ms, {1.0, 0.0});
  drive(5ms, 0.8);
  drive(10ms, 1.0);
  ASSERT_EQ(monitor_.events().size(), 1U);
  const time::Duration late = monitor_.events()[0].limit() + 2ms;
  drive(late, 0.8);
  EXPECT_EQ(monitor_.num_masked(), 0);
  ASSERT_EQ(monitor_.events().size(), 1U);
  EXPECT_FALSE(monitor_.events()[0].answered);
  drive(late + 10ms, 0.0);
  EXPECT_EQ(monitor_.events()[0].answered, time::SteadyTime(late + 10ms));
}

TEST_F(BrakeLatencyBesideUndisturbedRunTest, AnotherObstacleIsAnsweredByAnyDriveThatIsLower) {
  const sim::ActorState obstacle{{1.0, 0.0}, 0.1, 1.0};
  monitor_.update({time::SteadyTime(1ms), {}, 1.0, 0.3, {std::nullopt, {{obstacle, true}}}});
  drive(5ms, 0.8);
  ASSERT_EQ(monitor_.events().size(), 1U);
  EXPECT_EQ(monitor_.events()[0].answered, time::SteadyTime(5ms));
}

}  // namespace brake_latency_test
}  // namespace nodmap::trial
