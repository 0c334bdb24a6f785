// SPDX-License-Identifier: BSD-3-Clause
// The driver's core when base, adapter or process fall silent, or the line damages or delays what
// they send.
#include <gtest/gtest.h>

#include "drivers/kurt/kurt.hpp"
#include "drivers/kurt/test/kurt_robot.hpp"

namespace nodmap::kurt {
namespace kurt_losses_test {

using kurt_robot::Robot;

constexpr double kTickM = 0.379 / 21950.0;  // a tick of the encoders, default wheels

TEST(KurtLosses, ABaseThatFallsSilentIsToldToStop) {
  Robot robot;
  robot.run_for(500ms);
  robot.drive_for(1.0, 0.0, 1s);
  robot.base.base_off = true;
  robot.drive_for(1.0, 0.0, 210ms);
  EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kNoBase);
  EXPECT_EQ(robot.base.left_cm_s(), 0);
  robot.base.base_off = false;
  robot.drive_for(1.0, 0.0, 2s);
  EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kDriving);
  EXPECT_EQ(robot.base.left_cm_s(), 100);
  EXPECT_EQ(robot.kurt.counts().encoder_gaps, 1);
}

TEST(KurtLosses, AnAdapterThatResetsIsOpenedAgain) {
  Robot robot;
  robot.run_for(500ms);
  robot.drive_for(1.0, 0.0, 1s);
  robot.base.reset_adapter();
  robot.drive_for(1.0, 0.0, 1500ms);
  EXPECT_TRUE(robot.base.channel_open());
  EXPECT_EQ(robot.base.left_cm_s(), 100);
  EXPECT_EQ(robot.kurt.session().restarts(), 1);
}

TEST(KurtLosses, AMuteAdapterAsksForAnotherPort) {
  Robot robot;
  robot.run_for(500ms);
  robot.base.mute_adapter = true;
  robot.run_for(3s);
  EXPECT_TRUE(robot.kurt.wants_new_port());
  robot.kurt.disconnected();
  EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kNoLine);
  EXPECT_EQ(robot.kurt.control(robot.moment()), "");
  robot.base.mute_adapter = false;
  robot.kurt.connected(robot.moment());
  robot.run_for(500ms);
  EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kNoDrive);
}

// A command from before the loss of the line is not obeyed when the line is back.
TEST(KurtLosses, AfterALossTheRobotWaitsForANewDrive) {
  Robot robot;
  robot.run_for(500ms);
  robot.drive_for(1.0, 0.0, 1s);
  robot.kurt.disconnected();
  EXPECT_TRUE(robot.kurt.control(robot.moment()).empty());
  robot.kurt.connected(robot.moment());
  EXPECT_NE(robot.kurt.state(robot.now), KurtState::kDriving);
  // The bus is open again before the command's 200 ms are over.
  for (int i = 0; i < 100; ++i) {
    robot.step();
    EXPECT_TRUE(!robot.kurt.session().is_open() || robot.base.left_cm_s() == 0);
  }
  EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kNoDrive);
}

TEST(KurtLosses, AfterALossTheBaseCountsAsAbsentUntilItSendsAgain) {
  Robot robot;
  robot.run_for(500ms);
  robot.kurt.disconnected();
  robot.kurt.connected(robot.moment());
  const time::SteadyTime last_frame = robot.now;
  robot.base.base_off = true;
  while (!robot.kurt.session().is_open()) {
    robot.step();
  }
  ASSERT_LT(robot.now - last_frame, kBlind);
  EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kNoBase);
}

// Opening the bus takes longer than the base drives on without a command. The frames of 80 ms
// arrive at once, so the first of them was sent soon after that.
TEST(KurtLosses, ALossIsAGapOfOdometryHoweverShort) {
  Robot robot;
  robot.run_for(500ms);
  ASSERT_EQ(robot.kurt.counts().encoder_gaps, 0);
  robot.kurt.disconnected();
  robot.kurt.connected(robot.moment());
  while (!robot.kurt.session().is_open()) {
    robot.step();
  }
  robot.held_up_periods = 8;
  robot.run_for(200ms);
  EXPECT_EQ(robot.kurt.counts().encoder_gaps, 1);
}

TEST(KurtLosses, HalfALineFromBeforeALossIsForgotten) {
  Robot robot;
  robot.run_for(500ms);
  robot.to_driver = "t0098";
  robot.base.base_off = true;
  robot.step();
  robot.base.base_off = false;
  robot.kurt.disconnected();
  robot.kurt.connected(robot.moment());
  robot.run_for(500ms);
  EXPECT_EQ(robot.kurt.slcan_counts().malformed, 0);
}

// Three encoder frames lost at 1 m/s are 3 cm that odometry must not lose.
TEST(KurtLosses, LostEncoderFramesAreNoticedAndFilled) {
  Robot robot;
  robot.run_for(500ms);
  robot.drive_for(1.0, 0.0, 2s);
  const double before_m = robot.samples.back().state.T_odom_base.x;
  robot.base.drop_encoders = 3;
  robot.drive_for(1.0, 0.0, 2s);
  EXPECT_EQ(robot.kurt.counts().encoder_lost, 3);
  EXPECT_NEAR(robot.samples.back().state.T_odom_base.x - before_m, 2.0, kTickM);
}

TEST(KurtLosses, OnABadLineOdometryIsNotShort) {
  Robot robot;
  robot.run_for(500ms);
  robot.drive_for(1.0, 0.0, 2s);
  const double before_m = robot.samples.back().state.T_odom_base.x;
  for (int i = 0; i < 100; ++i) {
    robot.base.drop_encoders = 1;
    robot.drive_for(1.0, 0.0, 100ms);
  }
  EXPECT_EQ(robot.kurt.counts().encoder_gaps, 0);
  // 20 periods may not have been found yet, which are 2 %.
  EXPECT_NEAR(robot.samples.back().state.T_odom_base.x - before_m, 10.0, 0.2);
}

TEST(KurtLosses, ADamagedEncoderFrameIsBridged) {
  Robot robot;
  robot.run_for(500ms);
  robot.drive_for(1.0, 0.0, 2s);
  const double before_m = robot.samples.back().state.T_odom_base.x;
  const std::size_t samples_before = robot.samples.size();
  for (int i = 0; i < 20; ++i) {  // more than are bridged in a row
    robot.base.wild_encoders = 1;
    robot.drive_for(1.0, 0.0, 100ms);
    EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kDriving);
  }
  EXPECT_EQ(robot.kurt.counts().encoder_implausible, 20);
  EXPECT_EQ(robot.kurt.counts().encoder_lost, 0);
  EXPECT_EQ(robot.samples.size(), samples_before + 200);
  // Twenty periods are those before them again, each rounded by up to half a tick.
  EXPECT_NEAR(robot.samples.back().state.T_odom_base.x - before_m, 2.0, 2.0 * kTickM);
}

// Frames keep arriving, but none of them shows what the wheels do: as bad as no frames at all.
TEST(KurtLosses, ABaseThatSendsNothingPlausibleIsToldToStop) {
  Robot robot;
  robot.run_for(500ms);
  robot.drive_for(1.0, 0.0, 2s);
  const OdometrySample before = robot.samples.back();
  robot.base.wild_encoders = 300;
  robot.drive_for(1.0, 0.0, 190ms);
  EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kDriving);
  robot.drive_for(1.0, 0.0, 10ms);
  EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kNoBase);
  EXPECT_EQ(robot.base.left_cm_s(), 0);
  robot.drive_for(1.0, 0.0, 2800ms);
  EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kNoBase);
  EXPECT_EQ(robot.base.left_cm_s(), 0);
  ASSERT_EQ(robot.base.wild_encoders, 0);
  // No odometry is returned except for the ten bridged periods.
  const OdometrySample& last = robot.samples.back();
  EXPECT_EQ(last.stamp - before.stamp, 100ms);
  // Ten times the ticks of the last period, each rounded by up to half a tick; measured 27 um.
  EXPECT_NEAR(last.state.T_odom_base.x - before.state.T_odom_base.x, 0.1, 2.0 * kTickM);
  EXPECT_EQ(robot.kurt.counts().encoder_implausible, 300);

  // The pose stays, and its uncertainty grows by half a second of rolling on.
  const OdometryState bridged = last.state;
  const std::size_t samples_before = robot.samples.size();
  robot.drive_for(1.0, 0.0, 1s);
  ASSERT_GT(robot.samples.size(), samples_before);
  const OdometryState& first_after = robot.samples[samples_before].state;
  EXPECT_DOUBLE_EQ(first_after.T_odom_base.x, bridged.T_odom_base.x);
  // The square of 0.5 m; whole ticks make 1 m/s smaller by 0.03 %.
  EXPECT_NEAR(first_after.covariance(0, 0) - bridged.covariance(0, 0), 0.25, 2e-4);
  EXPECT_EQ(robot.kurt.counts().encoder_gaps, 1);
  EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kDriving);
  EXPECT_EQ(robot.base.left_cm_s(), 100);
}

TEST(KurtLosses, ABaseThatNeverSentAnythingPlausibleCountsAsAbsent) {
  Robot robot;
  robot.base.wild_encoders = 1000;
  robot.drive_for(1.0, 0.0, 2s);
  EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kNoBase);
  EXPECT_TRUE(robot.samples.empty());
  EXPECT_EQ(robot.base.left_cm_s(), 0);
}

// The process was not scheduled for 80 or 150 ms: nothing is lost, and each sample has the time at
// which its frame was sent.
TEST(KurtLosses, ADelayedProcessLosesNothing) {
  Robot robot;
  robot.run_for(500ms);
  robot.drive_for(1.0, 0.0, 2s);
  const double before_m = robot.samples.back().state.T_odom_base.x;
  for (const int periods : {8, 10, 8, 10, 8}) {
    robot.held_up_periods = periods;
    robot.drive_for(1.0, 0.0, 400ms);
  }
  EXPECT_EQ(robot.kurt.counts().encoder_lost, 0);
  EXPECT_EQ(robot.kurt.counts().encoder_gaps, 0);
  EXPECT_NEAR(robot.samples.back().state.T_odom_base.x - before_m, 2.0, kTickM);
  for (std::size_t i = 1; i < robot.samples.size(); ++i) {
    EXPECT_EQ(robot.samples[i].stamp - robot.samples[i - 1].stamp, 10ms);
  }
}

// The base stops by itself after 100 ms without a command.
TEST(KurtLosses, AfterALateCommandTheWheelsStartWithARamp) {
  Robot robot;
  robot.run_for(500ms);
  robot.drive_for(1.0, 0.0, 2s);
  ASSERT_EQ(robot.base.left_cm_s(), 100);
  for (int i = 0; i < 15; ++i) {
    robot.now += 10ms;
    robot.to_driver += robot.base.tick();
  }
  ASSERT_EQ(robot.base.left_cm_s(), 0);
  robot.drive_for(1.0, 0.0, 100ms);
  EXPECT_EQ(robot.kurt.counts().encoder_gaps, 0);  // all frames have waited and are read now
  EXPECT_EQ(robot.kurt.counts().encoder_lost, 0);
  EXPECT_GT(robot.base.left_cm_s(), 0);
  EXPECT_LE(robot.base.left_cm_s(), 15);  // 1.5 m/s^2
  robot.drive_for(1.0, 0.0, 1s);
  EXPECT_EQ(robot.base.left_cm_s(), 100);
}

// Two seconds during which all that the adapter sends arrives late.
TEST(KurtLosses, ALateLineStopsTheRobotUntilItIsInTime) {
  for (const int periods : {10, 12, 15}) {
    Robot robot;
    robot.run_for(500ms);
    robot.drive_for(1.0, 0.0, 2s);
    robot.late_periods = periods;
    robot.drive_for(1.0, 0.0, 150ms);
    EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kLate);
    EXPECT_EQ(robot.base.left_cm_s(), 0);
    const std::size_t samples_before = robot.samples.size();
    robot.drive_for(1.0, 0.0, 1850ms);
    EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kLate);
    EXPECT_EQ(robot.samples.size(), samples_before) << "their time is unknown";
    EXPECT_EQ(robot.kurt.counts().encoder_lost, 0);
    robot.late_periods = 0;
    robot.run_for(200ms);
    EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kNoDrive);
    robot.drive_for(1.0, 0.0, 1s);
    EXPECT_EQ(robot.kurt.state(robot.now), KurtState::kDriving);
    EXPECT_EQ(robot.base.left_cm_s(), 100);
    // No period is lost or counted twice. The emulated base stops at once, as no real one does; the
    // two periods until that is believed are bridged, with half a tick each.
    EXPECT_NEAR(robot.samples.back().state.T_odom_base.x, robot.base.driven_m() + 0.02,
                2.0 * kTickM);
  }
}

TEST(KurtLosses, ItDrivesWithAnAdapterThatHasNoFlags) {
  Robot robot;
  robot.base.has_flags = false;
  robot.run_for(500ms);
  for (int i = 0; i < 100; ++i) {
    robot.drive_for(1.0, 0.0, 100ms);
    ASSERT_EQ(robot.kurt.state(robot.now), KurtState::kDriving) << i;
  }
  EXPECT_EQ(robot.base.left_cm_s(), 100);
}

}  // namespace kurt_losses_test
}  // namespace nodmap::kurt
