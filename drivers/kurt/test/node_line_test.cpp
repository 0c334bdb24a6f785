// SPDX-License-Identifier: BSD-3-Clause
// The driver's end, and a line or a base that fails.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>

#include "drivers/kurt/node.hpp"
#include "drivers/kurt/test/node_bench.hpp"
#include "tests/support/logged.hpp"

namespace nodmap::kurt {
namespace node_test {

TEST(KurtNode, TheEndIsAHardStop) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(0.5, 0.0, 1s);
  ASSERT_FALSE(bench.base.braked());
  bench.node->finish();
  bench.base.take(bench.pty->receive_text(kCommandBytes));
  EXPECT_TRUE(bench.base.braked());
  EXPECT_EQ(bench.node->poll_handles()[0], -1);
  bench.node->spin_once();  // does not open it again
  EXPECT_EQ(bench.node->poll_handles()[0], -1);
}

// As when the process ends by an exception.
TEST(KurtNode, EveryExitIsAHardStop) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(0.5, 0.0, 1s);
  ASSERT_FALSE(bench.base.braked());
  bench.node.reset();
  bench.base.take(bench.pty->receive_text(kCommandBytes));
  EXPECT_TRUE(bench.base.braked());
}

TEST(KurtNode, APulledPlugIsReportedAndRecoveredFrom) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(0.5, 0.0, 1s);
  bench.pty.reset();
  bench.drive_for(0.5, 0.0, 20ms);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kFailed);
  EXPECT_EQ(bench.node->health().reason, "the line is disconnected");
  bench.drive_for(0.5, 0.0, 1s);
  EXPECT_EQ(bench.node->health().reason, "/dev/kurt: No such file or directory");
  EXPECT_EQ(bench.status.get()->health, nodmap::status_t::FAILED);
  EXPECT_EQ(bench.status.get()->process_name, "nodmap-kurt");

  bench.base = {};
  bench.pty.emplace();
  // The pause between attempts is at most 1.6 s after 1 s, the opening takes 0.2 s.
  ASSERT_TRUE(bench.step_until(
      [&] { return bench.node->health().state == node::HealthState::kDegraded; }, 2s));
  EXPECT_EQ(bench.base.left_cm_s(), 0);  // waits for a new DRIVE
  bench.drive_for(0.5, 0.0, 1s);
  EXPECT_EQ(bench.base.left_cm_s(), 50);
  EXPECT_EQ(bench.node->metrics()["reconnects"], 1);
}

// It may have been switched off, and somebody may be working at it.
TEST(KurtNode, AfterALongAbsenceOfItsBaseItIsStoppedUntilReleased) {
  for (const bool is_unplugged : {false, true}) {
    Bench bench;
    ASSERT_TRUE(bench.becomes_ready());
    bench.drive_for(0.5, 0.0, 1s);
    bench.base.base_off = !is_unplugged;
    if (is_unplugged) {
      bench.pty.reset();
    }
    bench.drive_for(0.5, 0.0, 6s);
    if (is_unplugged) {
      bench.base = {};
      bench.pty.emplace();
    }
    bench.base.base_off = false;
    int fastest_cm_s = 0;
    // The pause between attempts is at most 5 s.
    for (const time::SteadyTime end = bench.now + 7s; bench.now < end;) {
      bench.drive_for(0.5, 0.0, 10ms);
      fastest_cm_s = std::max(fastest_cm_s, bench.base.left_cm_s());
    }
    EXPECT_EQ(fastest_cm_s, 0);
    EXPECT_EQ(bench.node->health().reason,
              "stopped by the return of its base: stationary until released (nodmap-stop --go)");
    bench.publish_stop(false);
    bench.drive_for(0.5, 0.0, 1s);
    EXPECT_EQ(bench.base.left_cm_s(), 50);
  }
}

// The adapter answers all the time.
TEST(KurtNode, WithoutItsBaseItSaysSoAllTheTime) {
  for (const bool from_the_start : {true, false}) {
    Bench bench;
    bench.base.base_off = from_the_start;
    bench.drive_for(0.5, 0.0, 1s);
    bench.base.base_off = true;
    bench.drive_for(0.5, 0.0, 500ms);
    for (int i = 0; i < 1000; ++i) {
      bench.step();
      EXPECT_EQ(bench.node->health().reason,
                "no plausible encoder frames: is the base switched on?");
    }
    EXPECT_GT(bench.node->metrics()["reconnects"], 1);
  }
}

TEST(KurtNode, AReleaseBeforeItsBaseIsSwitchedOnIsNotObeyedLongAfter) {
  Bench bench;
  bench.base.base_off = true;
  bench.publish_stop(false);
  bench.drive_for(0.5, 0.0, 6s);
  bench.base.base_off = false;
  bench.drive_for(0.5, 0.0, 7s);
  EXPECT_EQ(bench.base.left_cm_s(), 0);
  EXPECT_NE(bench.node->health().reason.find("the return of its base"), std::string::npos)
      << bench.node->health().reason;
}

TEST(KurtNode, AfterAShortAbsenceOfItsBaseItDrivesOn) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(0.5, 0.0, 1s);
  bench.base.base_off = true;
  bench.drive_for(0.5, 0.0, 3s);
  bench.base.base_off = false;
  bench.drive_for(0.5, 0.0, 2s);
  EXPECT_EQ(bench.base.left_cm_s(), 50);
}

TEST(KurtNode, ABaseThatSendsNothingPlausibleIsFailedAndNoOdometryIsPublished) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(0.5, 0.0, 1s);
  bench.base.wild_encoders = 1000;
  bench.drive_for(0.5, 0.0, 250ms);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kFailed);
  EXPECT_EQ(bench.base.left_cm_s(), 0);
  const auto told = bench.odometry.count();
  bench.drive_for(0.5, 0.0, 1s);
  EXPECT_EQ(bench.odometry.count(), told);
  EXPECT_EQ(bench.base.left_cm_s(), 0);
}

TEST(KurtNode, StatusCountsEncoderFramesThatWereLostOrImplausible) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(0.5, 0.0, 500ms);
  bench.base.drop_encoders = 3;
  bench.drive_for(0.5, 0.0, 100ms);
  bench.base.wild_encoders = 2;
  bench.drive_for(0.5, 0.0, 2400ms);  // losses are found within a second, STATUS is due every one
  EXPECT_EQ(bench.status.get()->total_lost, 5);
}

TEST(KurtNode, LostEncoderFramesDegrade) {
  using node::HealthState;
  for (const auto& [num_lost, of, state] : {std::tuple(1, 20, HealthState::kOk),
                                            {1, 5, HealthState::kDegraded},
                                            {5, 6, HealthState::kDegraded}}) {
    Bench bench;
    ASSERT_TRUE(bench.becomes_ready());
    // A loss is known within a second, and judged with those of a second.
    for (int i = 0; i < 300 / of; ++i) {
      bench.base.drop_encoders = num_lost;
      bench.drive_for(0.5, 0.0, of * 10ms);
    }
    EXPECT_EQ(bench.node->health().state, state) << bench.node->health().reason;
    bench.drive_for(0.5, 0.0, 3s);
    EXPECT_EQ(bench.node->health().state, HealthState::kOk) << bench.node->health().reason;
  }
}

TEST(KurtNode, AMuteAdapterIsFailedAndThePortIsOpenedAgain) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.base.mute_adapter = true;
  ASSERT_TRUE(bench.step_until(
      [&] { return bench.node->health().state == node::HealthState::kFailed; }, 500ms));
  ASSERT_TRUE(bench.step_until([&] { return bench.node->metrics()["reconnects"] >= 1; }, 4s));
  EXPECT_EQ(bench.node->health().reason, "the CAN bus is not open: the adapter has not answered");
  bench.base.mute_adapter = false;
  EXPECT_TRUE(bench.step_until(
      [&] { return bench.node->health().state == node::HealthState::kDegraded; }, 10s));
}

TEST(KurtNode, ALineThatAcceptsNoBytesIsGivenUp) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  // Nothing reads on the device's side, so the terminal fills up.
  for (int i = 0; i < 5000 && bench.node->poll_handles()[0] >= 0; ++i) {
    bench.pass();
    bench.pty->send(bench.base.tick());
    await_input(bench.node->poll_handles()[0], 1);
    bench.node->spin_once();
  }
  EXPECT_EQ(bench.node->health().state, node::HealthState::kFailed);
  EXPECT_EQ(bench.node->health().reason, "the line does not accept bytes");
}

TEST(KurtNode, AnAdapterThatAnswersNoQuestionIsCalledThat) {
  Bench bench;
  bench.base.has_flags = false;
  bench.base.has_version = false;
  ASSERT_TRUE(bench.becomes_ready());
  ASSERT_TRUE(bench.step_until(
      [&] { return bench.node->health().state == node::HealthState::kFailed; }, 2s));
  EXPECT_EQ(bench.node->health().reason.find("the adapter answers neither F nor V"), 0U);
}

TEST(KurtNode, AnAdapterWithoutFlagsIsLoggedOnce) {
  Bench bench;
  bench.base.has_flags = false;
  ASSERT_TRUE(bench.becomes_ready());
  const std::string text = test::logged([&] { bench.drive_for(0.5, 0.0, 10s); });
  EXPECT_EQ(bench.base.left_cm_s(), 50);
  const std::size_t at = text.find("the adapter does not support F");
  EXPECT_NE(at, std::string::npos) << text;
  EXPECT_EQ(text.rfind("the adapter does not support F"), at);
}

}  // namespace node_test
}  // namespace nodmap::kurt
