// SPDX-License-Identifier: BSD-3-Clause
// Whose DRIVE the driver obeys.
#include <gtest/gtest.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "drivers/kurt/node.hpp"
#include "drivers/kurt/test/node_bench.hpp"
#include "nodmap/drive_t.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap::kurt {
namespace node_test {

// A second sender of DRIVE: faster, and stamped ahead of the clock.
TEST(KurtNode, ASecondSenderOfDriveStopsTheRobotAndIsReported) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(0.5, 0.0, 1s);
  ASSERT_EQ(bench.base.left_cm_s(), 50);
  bus::LoopBus other(bench.network);
  nodmap::drive_t forged{};
  forged.forward_mps = 5.0;
  forged.valid_us = 1'000'000;
  for (int i = 0; i < 100; ++i) {
    forged.utime = time::to_utime(bench.clock.now()) + 4'000;
    forged.drive_seq = bench.drive_seq;
    other.publish("DRIVE", forged);
    bench.drive_for(0.5, 0.0, 10ms);
    EXPECT_LE(bench.base.left_cm_s(), 50);
  }
  EXPECT_EQ(bench.base.left_cm_s(), 0);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kFailed);
  EXPECT_NE(bench.node->health().reason.find("two processes send DRIVE"), std::string::npos);
  EXPECT_GE(bench.counts.rejected().at("drive_other_sender"), 100);
  bench.drive_for(0.5, 0.0, 2s);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kOk);
  EXPECT_EQ(bench.base.left_cm_s(), 50);
}

// A navigator that has been restarted does not know that the robot was to stand.
TEST(KurtNode, AnotherSenderOfDriveIsObeyedOnlyAfterARelease) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(0.0, 0.0, 1s);
  const bus::Latest<nodmap::stop_t> stop(bench.bus, "STOP");
  bus::LoopBus restarted(bench.network);
  std::int64_t drive_seq = 0;
  const auto moves = [&] {
    nodmap::drive_t message = bench.drive(0.5, 0.0);
    message.drive_seq = drive_seq++;
    restarted.publish("DRIVE", message);
    bench.step();
    return bench.base.left_cm_s() != 0;
  };
  EXPECT_FALSE(bench.step_until(moves, 2s));
  ASSERT_TRUE(stop.get());
  EXPECT_EQ(stop.get()->requested_by, "nodmap-kurt, for a new sender of DRIVE");
  bench.publish_stop(false);
  EXPECT_TRUE(bench.step_until(moves, 200ms));
}

// The release was given before that navigator was started.
TEST(KurtNode, ACopyOfAReleasePermitsNoOtherSenderOfDrive) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.publish_stop(false);
  bench.drive_for(0.5, 0.0, 100ms);
  bench.step_until([] { return false; }, 300ms);
  --bench.stop_utime;
  bench.publish_stop(false);
  bus::LoopBus restarted(bench.network);
  restarted.publish("DRIVE", bench.drive(0.5, 0.0));
  EXPECT_FALSE(bench.step_until([&] { return bench.base.left_cm_s() != 0; }, 100ms));
}

// Whoever starts the navigator again may release the robot before it sends anything.
TEST(KurtNode, AReleaseAlsoPermitsASenderOfDriveThatComesLater) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(0.5, 0.0, 1s);
  bench.step_until([] { return false; }, 1s);
  bench.publish_stop(false);
  bench.step_until([] { return false; }, 1s);
  bus::LoopBus restarted(bench.network);
  restarted.publish("DRIVE", bench.drive(0.5, 0.0));
  EXPECT_TRUE(bench.step_until([&] { return bench.base.left_cm_s() != 0; }, 100ms));
}

// Frozen for half a second, longer than a sender may be silent. Of what it reads then, somebody
// else's message is the first that is not too old.
TEST(KurtNode, AFrozenDriverGoesOnFollowingItsSenderOfDrive) {
  Bench bench;
  ASSERT_TRUE(bench.becomes_ready());
  bench.drive_for(0.5, 0.0, 1s);
  bus::LoopBus other(bench.network);
  nodmap::drive_t forged{};
  forged.forward_mps = -0.5;
  forged.valid_us = 1'000'000;
  for (int i = 0; i < 50; ++i) {
    bench.pass();
    if (i == 31) {
      forged.utime = time::to_utime(bench.clock.now());
      other.publish("DRIVE", forged);
    }
    bench.publish_drive(0.5, 0.0);
  }
  bench.drive_for(0.5, 0.0, 1s);
  EXPECT_EQ(bench.counts.rejected().at("drive_other_sender"), 1);
  EXPECT_EQ(bench.node->health().state, node::HealthState::kOk) << bench.node->health().reason;
  EXPECT_EQ(bench.base.left_cm_s(), 50);
}

}  // namespace node_test
}  // namespace nodmap::kurt
