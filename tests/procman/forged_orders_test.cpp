// SPDX-License-Identifier: BSD-3-Clause
// What anybody can order while no sheriff runs. The deputy runs only what its own file lists, and
// does not trust the network.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>

#include "tests/procman/sheriff_fixture.hpp"

namespace nodmap {
namespace forged_orders_test {

using test::SheriffProcess;

class ForgedOrders : public SheriffProcess {
 protected:
  /// The group runs, and the sheriff that has started it has ended.
  void start_group() {
    begin_deputy();
    const auto start = sheriff({"--start", "g"});
    ASSERT_EQ(start.exit_code, 0) << start.out << start.err;
    ASSERT_TRUE(
        client_.wait_until([this] { return client_.runs("sleeper") && client_.runs("talker"); }));
  }
};

TEST_F(ForgedOrders, AnOrderThatOmitsTheCommandsStopsNone) {
  start_group();
  const int sleeper = client_.status("sleeper").pid;
  const int talker = client_.status("talker").pid;
  client_.order({});
  ASSERT_TRUE(client_.wait_for_infos(3));
  EXPECT_EQ(client_.status("sleeper").pid, sleeper);
  EXPECT_EQ(client_.status("talker").pid, talker);
}

// A stop by SIGSTOP, with a day until SIGKILL: a base driver that is frozen stops the robot, but
// nothing would start it again.
TEST_F(ForgedOrders, AStopSignalThatFreezesIsReplaced) {
  start_group();
  const procman::CommandStatus running = client_.status("talker");
  procman::CommandOrder order;
  order.spec = running.spec;
  order.spec.stop_signal = SIGSTOP;
  order.spec.stop_time_allowed_s = 86'400.0;
  order.desired_run = running.actual_run;
  client_.order({order});
  ASSERT_TRUE(client_.wait_for_infos(3));
  EXPECT_EQ(client_.status("talker").pid, running.pid) << "a new description stops nothing";
  order.force_quit = true;
  client_.order({order});
  EXPECT_TRUE(client_.wait_until([this] { return !client_.runs("talker"); },
                                 std::chrono::milliseconds(70'000)))
      << "within a minute";
  EXPECT_TRUE(client_.runs("sleeper"));
}

}  // namespace forged_orders_test
}  // namespace nodmap
