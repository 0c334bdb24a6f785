// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/ground_truth_monitor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "nodmap/pitch_state_t.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::trial {
namespace ground_truth_monitor_test {

using ::testing::DoubleEq;
using ::testing::ElementsAre;

class GroundTruthMonitorTest : public ::testing::Test {
 protected:
  /// At `at` the head is in this sweep, as its driver counts.
  void nod(time::Duration at, std::int64_t sweep) {
    nodmap::pitch_state_t message{};
    message.utime = time::to_utime(kStart.wall + at);
    message.sweep_count = sweep;
    network_.set_time(kStart.wall + at);
    bus_.publish("PITCH_STATE", message);
    network_.deliver();
  }

  test::TemporaryDir dir_;
  sim::World world_;
  sim::RobotModel model_{world_, {}, 1};
  bus::LoopNetwork network_{dir_.path() / "trial.lcmlog", {}};
  bus::LoopBus bus_{network_};
  GroundTruthMonitor monitor_{world_, model_, network_, {}};
};

TEST_F(GroundTruthMonitorTest, ASweepLastsFromOneReversalToTheNext) {
  nod(0ms, 0);  // from the rest position
  nod(700ms, 1);
  nod(1000ms, 1);
  nod(1200ms, 2);
  nod(1600ms, 3);
  EXPECT_THAT(monitor_.record().sweep_times_s, ElementsAre(DoubleEq(0.5), DoubleEq(0.4)));
}

TEST_F(GroundTruthMonitorTest, TheTimeWithoutADriverIsNoSweep) {
  nod(0ms, 0);
  nod(500ms, 1);
  nod(1000ms, 2);
  nod(5000ms, 0);  // restarted
  nod(5300ms, 1);
  nod(5700ms, 2);
  EXPECT_THAT(monitor_.record().sweep_times_s, ElementsAre(DoubleEq(0.5), DoubleEq(0.4)));
}

}  // namespace ground_truth_monitor_test
}  // namespace nodmap::trial
