// SPDX-License-Identifier: BSD-3-Clause
// Processes that send in the name of another.
#include "modules/viewer/foxglove/process_feed.hpp"

#include <gtest/gtest.h>

#include <string>

#include "common/bus/loop_bus.hpp"
#include "modules/viewer/foxglove/foxglove.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::foxglove {
namespace process_feed_test {

class ProcessFeedTest : public ::testing::Test {
 protected:
  template <class Message>
  void send(bus::Bus& sender, const char* channel, const Message& message) {
    network_.set_time({now_, time::SteadyTime(now_.time_since_epoch())});
    sender.publish(channel, message);
    network_.deliver();
  }
  void send_status(bus::Bus& sender, std::int8_t health) {
    nodmap::status_t status{};
    status.process_name = "nodmap-slam2d";
    status.health = health;
    send(sender, "STATUS", status);
  }
  // The newest message on a topic.
  [[nodiscard]] Json newest(const std::string& name) const {
    for (std::size_t i = 0; i < store_.topics().size(); ++i) {
      std::uint64_t cursor = 0;
      if (store_.topics()[i].name == name) {
        return Json::parse(store_.next(i, cursor)->text());
      }
    }
    return {};
  }
  [[nodiscard]] Json shown() const { return newest("STATUS")["processes"][0]; }

  nodmap::test::TemporaryDir dir_;
  bus::LoopNetwork network_{dir_.path() / "log", {}};
  bus::LoopBus bus_{network_};
  bus::LoopBus own_{network_};
  bus::LoopBus other_{network_};
  TopicStore store_;
  node::MessageCounts counts_;
  ProcessFeed feed_{bus_, store_, counts_};
  time::Timestamp now_{1000s};
};

TEST_F(ProcessFeedTest, AForgedStatusIsNotShownButReported) {
  send_status(own_, nodmap::status_t::OK);
  for (int i = 0; i < 3; ++i) {
    now_ += 500ms;
    send_status(other_, nodmap::status_t::FAILED);
    EXPECT_NE(shown()["health"], nodmap::status_t::FAILED);
    now_ += 500ms;
    send_status(own_, nodmap::status_t::OK);
    EXPECT_EQ(shown()["health"], nodmap::status_t::DEGRADED);
    EXPECT_NE(shown()["health_reason"].get<std::string>().find("another process"),
              std::string::npos);
  }
  EXPECT_EQ(counts_.rejected().at("other_sender_of_status"), 3);
  for (int i = 0; i < 4; ++i) {
    now_ += 1s;
    send_status(own_, nodmap::status_t::OK);
  }
  EXPECT_EQ(shown()["health"], nodmap::status_t::OK) << "it is over";
}

TEST_F(ProcessFeedTest, ARestartedProcessIsShownWhenTheFormerIsSilent) {
  send_status(own_, nodmap::status_t::OK);
  now_ += 3500ms;
  send_status(other_, nodmap::status_t::DEGRADED);
  EXPECT_EQ(shown()["health"], nodmap::status_t::DEGRADED);
  EXPECT_EQ(shown()["health_reason"], "");
}

TEST_F(ProcessFeedTest, AForgedInfoIsNotShown) {
  procman_lcm::deputy_info_t info{};
  info.deputy_id = "robot";
  info.cpu_load = 0.5F;
  send(own_, "PM_INFO", info);
  info.cpu_load = 0.75F;
  send(other_, "PM_INFO", info);
  EXPECT_EQ(newest("PM_INFO")["hosts"][0]["cpu_share"], 0.5);
  EXPECT_EQ(counts_.rejected().at("other_sender_of_pm_info"), 1);
}

procman_lcm::deputy_info_t info_of(const std::string& host) {
  procman_lcm::cmd_status_t status{};
  status.cmd.command_id = "of " + host;
  status.pid = 17;
  procman_lcm::deputy_info_t info{};
  info.deputy_id = host;
  info.ncmds = 1;
  info.cmds = {status};
  return info;
}

// A deputy's commands die with it, but nobody says so.
TEST_F(ProcessFeedTest, CommandsOfASilentHostHaveNoDeputy) {
  const auto state = [this](std::size_t i) { return newest("PM_INFO")["commands"][i]["state"]; };
  send(own_, "PM_INFO", info_of("a"));
  send(other_, "PM_INFO", info_of("b"));
  EXPECT_EQ(state(0), "running");
  now_ += 4s;
  send(own_, "PM_INFO", info_of("a"));
  EXPECT_EQ(state(0), "running");
  EXPECT_EQ(state(1), "no deputy");
  EXPECT_EQ(newest("PM_INFO")["hosts"][1]["age_s"], 4.0);
  now_ += 4s;
  send_status(own_, nodmap::status_t::OK);  // such as the viewer's own
  EXPECT_EQ(state(0), "no deputy");
  send(other_, "PM_INFO", info_of("b"));
  EXPECT_EQ(state(1), "running");
}

}  // namespace process_feed_test
}  // namespace nodmap::foxglove
