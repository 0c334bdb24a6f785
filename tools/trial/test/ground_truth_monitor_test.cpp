// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/ground_truth_monitor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "nodmap/navigation_t.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::trial {
namespace ground_truth_monitor_test {

using ::testing::DoubleEq;
using ::testing::ElementsAre;

class GroundTruthMonitorTest : public ::testing::Test {
 protected:
  // At `at` the head is in this sweep, as its driver counts.
  void nod(time::Duration at, std::int64_t sweep) {
    nodmap::pitch_state_t message{};
    message.utime = time::to_utime(kStart.wall + at);
    message.sweep_count = sweep;
    network_.set_time({kStart.wall + at, kStart.steady + at});
    bus_.publish("PITCH_STATE", message);
    network_.deliver();
  }

  // The navigator says that the robot is at the goal, or on the way to it.
  void report(time::Duration at, std::int8_t behaviour, std::int64_t goal_utime) {
    nodmap::navigation_t message{};
    message.behaviour = behaviour;
    message.goal_utime = goal_utime;
    network_.set_time({kStart.wall + at, kStart.steady + at});
    bus_.publish("NAVIGATION", message);
    network_.deliver();
  }

  test::TemporaryDir dir_;
  sim::World world_;
  sim::RobotModel model_{world_, {}, 1};
  bus::LoopNetwork network_{dir_.path() / "trial.lcmlog", {}};
  bus::LoopBus bus_{network_};
  GroundTruthMonitor monitor_{
      world_, model_, network_, BrakeLatencyMonitor{StoppingZone{}}, {0.15, 0.0, 0.38}, {}};
};

TEST_F(GroundTruthMonitorTest, ASweepLastsFromOneReversalToTheNext) {
  nod(0ms, 0);  // from the rest position
  nod(700ms, 1);
  nod(1000ms, 1);
  nod(1200ms, 2);
  nod(1600ms, 3);
  EXPECT_THAT(monitor_.record().sweep_times_s, ElementsAre(DoubleEq(0.5), DoubleEq(0.4)));
}

// At the second goal it is already when that is given; the first one it leaves and reaches again.
TEST_F(GroundTruthMonitorTest, EachGoalIsArrivedAtOnce) {
  constexpr std::int8_t kArrived = nodmap::navigation_t::ARRIVED;
  report(0ms, nodmap::navigation_t::STEER, 5);
  report(10ms, kArrived, 5);
  report(20ms, nodmap::navigation_t::STEER, 5);
  report(30ms, kArrived, 5);
  EXPECT_EQ(monitor_.record().arrivals.size(), 1U);
  report(40ms, kArrived, 6);
  report(50ms, kArrived, 6);
  EXPECT_EQ(monitor_.record().arrivals.size(), 2U);
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
