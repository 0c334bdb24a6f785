// SPDX-License-Identifier: BSD-3-Clause
// Two sheriffs that give orders to one deputy.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "nodmap/status_t.hpp"
#include "procman/protocol/messages.hpp"
#include "tests/procman/sheriff_fixture.hpp"

namespace nodmap {
namespace second_sheriff_test {

using test::kPatience;
using test::SheriffProcess;
using ::testing::HasSubstr;

TEST_F(SheriffProcess, ASecondSheriffYields) {
  begin_both();
  const auto second = sheriff({"--stop", "g"});
  EXPECT_EQ(second.exit_code, 3);
  EXPECT_THAT(second.err, HasSubstr("gives orders here already"));
  EXPECT_EQ(sheriff({"--script", "down"}).exit_code, 3);
  EXPECT_TRUE(client_.runs("sleeper"));
  sheriff_->send_signal(SIGTERM);
  EXPECT_EQ(sheriff_->wait_for_end(kPatience), 0);
}

// Orders of a sheriff that is older by its id, and that never comes again: they stop nothing, and
// this sheriff does not yield, although it has just begun.
TEST_F(SheriffProcess, OrdersOfASecondSheriffAreRefused) {
  begin_both();
  const bus::Latest<nodmap::status_t> status(client_.bus(), "STATUS");
  const int pid = client_.status("sleeper").pid;
  const procman::Orders forged{
      time::SystemClock().now(), "rover", "x:1:1", {test::wanted("sleeper", "x", 0, true)}};
  client_.bus().publish(procman::kOrdersChannel, to_message(forged));
  EXPECT_TRUE(client_.wait_until([&] {
    return status.get() && status.get()->health_reason.find("second sheriff") != std::string::npos;
  }));
  EXPECT_TRUE(client_.wait_for_infos(5));
  EXPECT_EQ(printed().find("observing only"), std::string::npos) << printed();
  EXPECT_EQ(client_.status("sleeper").pid, pid);
  const auto second = sheriff({"--stop", "g"});
  EXPECT_EQ(second.exit_code, 3) << "it gives orders: " << second.out << second.err;
}

// It has seen the command down, and a later run of it ordered by others.
TEST_F(SheriffProcess, AnObserverShowsWhatOtherSheriffsHaveStarted) {
  begin_deputy();
  ASSERT_EQ(sheriff({"--start", "sleeper"}).exit_code, 0);
  begin_task("--observe");
  ASSERT_TRUE(client_.wait_until([this] { return has_printed("talker: Stopped (OK)\n"); }));
  ASSERT_EQ(sheriff({"--start", "talker"}).exit_code, 0);
  EXPECT_TRUE(client_.wait_until([this] { return has_printed("talker: Running\n"); })) << printed();
  ASSERT_EQ(sheriff({"--restart", "sleeper"}).exit_code, 0);
  EXPECT_TRUE(client_.wait_for_infos(2));
  EXPECT_FALSE(has_printed("Command Sent")) << printed();
}

// It need not wait until the deputy takes the first one for dead.
TEST_F(SheriffProcess, TheNextSheriffIsObeyedAtOnce) {
  begin_deputy();
  const bus::Latest<nodmap::status_t> status(client_.bus(), "STATUS");
  EXPECT_EQ(sheriff({"--start", "sleeper"}).exit_code, 0);
  EXPECT_EQ(sheriff({"--stop", "sleeper"}).exit_code, 0);
  const std::int64_t count = status.count();
  ASSERT_TRUE(client_.wait_until([&] { return status.count() > count; }));
  EXPECT_EQ(status.get()->total_rejected, 0);
}

// A sheriff that has received one forged order looks whether it is repeated, and then begins.
TEST_F(SheriffProcess, OneForgedOrderDoesNotKeepASheriffFromBeginning) {
  begin_deputy();
  const bus::Latest<procman_lcm::discovery_t> discovery(client_.bus(), procman::kDiscoverChannel);
  begin_sheriff("up");
  ASSERT_TRUE(client_.wait_until([&] { return discovery.count() > 0; })) << "it listens";
  const procman::Orders forged{time::SystemClock().now(), "rover", "x:1:1", {}};
  client_.bus().publish(procman::kOrdersChannel, to_message(forged));
  EXPECT_TRUE(
      client_.wait_until([this] { return client_.runs("sleeper") && client_.runs("talker"); }));
}

}  // namespace second_sheriff_test
}  // namespace nodmap
