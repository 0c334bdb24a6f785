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

using test::kPatience;
using test::SheriffProcess;

// How often a text contains a word.
std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    ++found;
  }
  return found;
}

class ForgedOrders : public SheriffProcess {
 protected:
  // The group runs, and the sheriff that has started it has ended.
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

// They are to run again whenever they end.
TEST_F(ForgedOrders, AThousandUnknownCommandsDoNotFillTheJournal) {
  begin_deputy();
  std::vector<procman::CommandOrder> orders(1000);
  for (std::size_t i = 0; i < orders.size(); ++i) {
    orders[i].spec.id = std::to_string(i);
    orders[i].spec.exec = "made up";
    orders[i].spec.auto_respawn = true;
    orders[i].desired_run = 1;
  }
  client_.order(std::move(orders));
  ASSERT_TRUE(client_.wait_until([this] { return client_.status("999").wait_status != 0; }));
  ASSERT_TRUE(client_.wait_for_infos(3)) << "one a second";
  deputy_->send_signal(SIGTERM);
  EXPECT_EQ(deputy_->wait_for_end(kPatience), 0);
  EXPECT_EQ(count(deputy_->said(), "refused"), 1U) << deputy_->said();
  deputy_.reset();
}

}  // namespace forged_orders_test
}  // namespace nodmap
