// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/status.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/bus/live_bus.hpp"
#include "nodmap/status_t.hpp"
#include "tests/support/manual_clock.hpp"

namespace nodmap::node {
namespace status_test {

class FakeNode : public Node {
 public:
  void write_results(const std::filesystem::path&) override {}
  [[nodiscard]] nlohmann::json metrics() const override { return {}; }
  [[nodiscard]] Health health() const override { return health_; }
  Health health_;
};

// Sets what the transport of a live bus counts.
class CountedBus final : public bus::Bus {
 public:
  [[nodiscard]] bus::BusCounts counts() const override { return counted; }

  bus::BusCounts counted;
  nodmap::status_t sent{};

 private:
  bool send(const std::string& /*channel*/, std::span<const std::byte> bytes) override {
    return bus::decode_into(sent, bytes);
  }
  void listen(const std::string& /*channel*/, BytesHandler /*handler*/, int /*queue*/) override {}
};

class StatusTest : public ::testing::Test {
 protected:
  void handle_all() {
    while (bus_.handle(std::chrono::milliseconds(0)) > 0) {
    }
  }

  bus::LiveBus bus_{"memq://"};
  MessageCounts counts_;
  test::ManualClock clock_{time::Timestamp(1s)};
  FakeNode node_;
  bus::Latest<nodmap::status_t> status_{bus_, "STATUS"};
};

TEST_F(StatusTest, ComesOnceASecondEvenWhenTheClockStepsBack) {
  StatusReporter reporter("nodmap-test", bus_, counts_, clock_);
  reporter.publish_if_due(node_);
  clock_.advance(999'999us);
  reporter.publish_if_due(node_);
  handle_all();
  EXPECT_EQ(status_.count(), 0);
  clock_.advance(1us);
  reporter.publish_if_due(node_);
  clock_.set(time::Timestamp(500ms));
  reporter.publish_if_due(node_);
  handle_all();
  EXPECT_EQ(status_.count(), 2);
}

TEST_F(StatusTest, SilenceOfTheInputIsDegraded) {
  StatusReporter reporter("nodmap-test", bus_, counts_, clock_);
  clock_.advance(1s);
  reporter.publish_if_due(node_);
  handle_all();
  ASSERT_TRUE(status_.get().has_value());
  EXPECT_EQ(status_.get()->health, nodmap::status_t::DEGRADED);
  EXPECT_EQ(status_.get()->process_name, "nodmap-test");
}

TEST_F(StatusTest, ADriverNeedsNoMessages) {
  StatusReporter reporter("nodmap-test", bus_, counts_, clock_);
  node_.health_.needs_messages = false;
  clock_.advance(1s);
  reporter.publish_if_due(node_);
  handle_all();
  ASSERT_TRUE(status_.get().has_value());
  EXPECT_EQ(status_.get()->health, nodmap::status_t::OK);
}

TEST_F(StatusTest, CorruptMessagesAreReported) {
  StatusReporter reporter("nodmap-test", bus_, counts_, clock_);
  node_.health_.needs_messages = false;
  for (int i = 0; i < 11; ++i) {
    bus_.publish_bytes("STATUS", {});
  }
  handle_all();
  for (const auto health : {nodmap::status_t::DEGRADED, nodmap::status_t::OK}) {
    clock_.advance(1s);
    reporter.publish_if_due(node_);
    handle_all();
    ASSERT_TRUE(status_.get().has_value());
    EXPECT_EQ(status_.get()->health, health) << "only while they come";
    EXPECT_EQ(status_.get()->total_corrupt, 11);
  }
}

TEST_F(StatusTest, TheAddressOfARefusedHostIsReportedWhileItSends) {
  CountedBus bus;
  StatusReporter reporter("nodmap-test", bus, counts_, clock_);
  node_.health_.needs_messages = false;
  bus.counted.refused = 3;
  bus.counted.refused_host = "10.9.9.9";
  clock_.advance(1s);
  reporter.publish_if_due(node_);
  EXPECT_EQ(bus.sent.health, nodmap::status_t::DEGRADED);
  EXPECT_NE(bus.sent.health_reason.find("10.9.9.9"), std::string::npos) << bus.sent.health_reason;
  EXPECT_EQ(bus.sent.total_rejected, 3);
  clock_.advance(1s);
  reporter.publish_if_due(node_);
  EXPECT_EQ(bus.sent.health, nodmap::status_t::OK);
}

TEST_F(StatusTest, DroppedMessagesAreReportedWhileThereAreMore) {
  CountedBus bus;
  StatusReporter reporter("nodmap-test", bus, counts_, clock_);
  node_.health_.needs_messages = false;
  for (const int overrun : {5, 7}) {
    bus.counted.overrun = overrun;
    clock_.advance(1s);
    reporter.publish_if_due(node_);
    EXPECT_EQ(bus.sent.health, nodmap::status_t::DEGRADED);
  }
  EXPECT_EQ(bus.sent.health_reason.find("2 messages dropped"), 0U) << bus.sent.health_reason;
  clock_.advance(1s);
  reporter.publish_if_due(node_);
  EXPECT_EQ(bus.sent.health, nodmap::status_t::OK);
}

TEST_F(StatusTest, TheNodesOwnHealthTakesPrecedence) {
  StatusReporter reporter("nodmap-test", bus_, counts_, clock_);
  node_.health_ = {HealthState::kFailed, "the disk is full"};
  counts_.reject("x");
  counts_.lose(2);
  clock_.advance(2s);
  reporter.publish_if_due(node_);
  handle_all();
  EXPECT_EQ(status_.get()->health, nodmap::status_t::FAILED);
  EXPECT_EQ(status_.get()->health_reason, "the disk is full");
  EXPECT_EQ(status_.get()->total_rejected, 1);
  EXPECT_EQ(status_.get()->total_lost, 2);
}

}  // namespace status_test
}  // namespace nodmap::node
