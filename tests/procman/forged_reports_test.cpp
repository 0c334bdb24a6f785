// SPDX-License-Identifier: BSD-3-Clause
// A process that reports to the sheriff in the name of another.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "nodmap/status_t.hpp"
#include "procman/protocol/messages.hpp"
#include "tests/procman/sheriff_fixture.hpp"

namespace nodmap {
namespace forged_reports_test {

using test::SheriffProcess;

class ForgedReports : public SheriffProcess {
 protected:
  // Calls `act` until `condition` holds; false if it does not in time.
  template <class Act, class Condition>
  bool repeat_until(Act act, Condition condition) {
    return client_.wait_until([&] {
      act();
      return condition();
    });
  }
  static nodmap::status_t status_of_sleeper(std::int8_t health) {
    nodmap::status_t status{};
    status.process_name = "sleeper";
    status.health = health;
    return status;
  }

  bus::LiveBus forger_{test::kProcmanUrl};
};

// "sleeper" is restarted when it has been FAILED for more than a second.
TEST_F(ForgedReports, AForgedStatusRestartsNothingAndIsReported) {
  begin_both();
  const int pid = client_.status("sleeper").pid;
  // This test sends its STATUS, so that it is the first.
  client_.bus().publish("STATUS", status_of_sleeper(nodmap::status_t::OK));
  const auto send_both = [this] {
    client_.bus().publish("STATUS", status_of_sleeper(nodmap::status_t::OK));
    forger_.publish("STATUS", status_of_sleeper(nodmap::status_t::FAILED));
  };
  EXPECT_TRUE(repeat_until(send_both, [this] {
    return has_printed("another process sends STATUS as sleeper");
  })) << printed();
  const std::size_t infos = client_.infos().size();
  EXPECT_TRUE(
      repeat_until(send_both, [this, infos] { return client_.infos().size() >= infos + 4; }));
  EXPECT_EQ(client_.status("sleeper").pid, pid);
  EXPECT_FALSE(has_printed("restarting")) << printed();
}

// The process is FAILED, and another says each time that it is OK.
TEST_F(ForgedReports, AForgedStatusHidesNoFailure) {
  begin_both();
  const int pid = client_.status("sleeper").pid;
  client_.bus().publish("STATUS", status_of_sleeper(nodmap::status_t::FAILED));
  const auto send_both = [this] {
    client_.bus().publish("STATUS", status_of_sleeper(nodmap::status_t::FAILED));
    forger_.publish("STATUS", status_of_sleeper(nodmap::status_t::OK));
  };
  EXPECT_TRUE(repeat_until(
      send_both, [&] { return client_.runs("sleeper") && client_.status("sleeper").pid != pid; }))
      << "it is restarted: " << printed();
}

// It says that "sleeper" has ended with exit code 3.
TEST_F(ForgedReports, AForgedInfoIsNotBelievedAndIsReported) {
  begin_both();
  const int pid = client_.status("sleeper").pid;
  const bus::Latest<nodmap::status_t> status(client_.bus(), "STATUS");
  const auto forge = [this] {
    procman::DeputyInfo info;
    info.deputy_id = "rover";
    info.commands.resize(1);
    info.commands[0].spec.id = "sleeper";
    info.commands[0].wait_status = 3 << 8;
    forger_.publish(procman::kInfoChannel, to_message(info));
  };
  const std::string reason = "another process reports as the deputy rover";
  EXPECT_TRUE(repeat_until(forge, [&] {
    return has_printed(reason) && status.get() && status.get()->health_reason == reason;
  })) << printed();
  EXPECT_FALSE(has_printed("exit 3")) << printed();
  // The client listens to everybody: its own last INFO may be the forged one.
  EXPECT_TRUE(client_.wait_until([this] { return client_.runs("sleeper"); }));
  EXPECT_EQ(client_.status("sleeper").pid, pid);
}

TEST_F(ForgedReports, AForgedOutputIsNotShown) {
  begin_deputy();
  ASSERT_EQ(sheriff({"--start", "talker"}).exit_code, 0);
  begin_task("--output talker");
  ASSERT_TRUE(client_.wait_until([this] { return has_printed("word"); }));
  const std::size_t length = printed().size();
  const auto forge = [this] {
    for (const char* channel : {procman::kOutputChannel, procman::kLastOutputChannel}) {
      forger_.publish(channel, to_message(procman::Output{{}, "rover", {{"talker", "forged\n"}}}));
    }
  };
  EXPECT_TRUE(repeat_until(forge, [&] { return printed().size() > length + 50; }));
  EXPECT_FALSE(has_printed("forged")) << printed();
  sheriff_->send_signal(SIGTERM);
  EXPECT_EQ(sheriff_->wait_for_end(test::kPatience), 0);
}

}  // namespace forged_reports_test
}  // namespace nodmap
