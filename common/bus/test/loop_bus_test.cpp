// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/loop_bus.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>

#include "nodmap/drive_t.hpp"
#include "nodmap/save_request_t.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::bus {
namespace {

nodmap::drive_t drive(std::int64_t seq) {
  nodmap::drive_t message{};
  message.drive_seq = seq;
  return message;
}

class LoopBusTest : public ::testing::Test {
 protected:
  test::TemporaryDir dir_;
  std::filesystem::path log_ = dir_.path() / "loop.lcmlog";
  LoopNetwork network_{log_, 1000};
  LoopBus sender_{network_};
  LoopBus receiver_{network_};
  std::vector<std::int64_t> got_;

  void note(Bus& bus) {
    bus.subscribe<nodmap::drive_t>(
        "DRIVE", [this](const nodmap::drive_t& message) { got_.push_back(message.drive_seq); });
  }
};

TEST_F(LoopBusTest, DeliversAfterTheDelayAndNotBefore) {
  note(receiver_);
  network_.set_time(5000);
  sender_.publish("DRIVE", drive(1));
  network_.deliver();
  network_.set_time(5999);
  network_.deliver();
  EXPECT_TRUE(got_.empty());
  network_.set_time(6000);
  network_.deliver();
  EXPECT_EQ(got_, (std::vector<std::int64_t>{1}));
}

TEST_F(LoopBusTest, KeepsTheOrderAcrossChannels) {
  note(receiver_);
  receiver_.subscribe<nodmap::drive_t>(
      "OTHER", [this](const nodmap::drive_t& message) { got_.push_back(-message.drive_seq); });
  sender_.publish("DRIVE", drive(1));
  sender_.publish("OTHER", drive(2));
  sender_.publish("DRIVE", drive(3));
  network_.set_time(1000);
  network_.deliver();
  EXPECT_EQ(got_, (std::vector<std::int64_t>{1, -2, 3}));
}

// Without a delay an answer is for the same time, and still comes after its question's handler.
TEST_F(LoopBusTest, AnAnswerWaitsUntilTheHandlerHasReturned) {
  LoopNetwork at_once(dir_.path() / "at_once.lcmlog", 0);
  LoopBus bus(at_once);
  bool within = false;
  bus.subscribe<nodmap::drive_t>("DRIVE", [&](const nodmap::drive_t& message) {
    EXPECT_FALSE(within);
    within = true;
    got_.push_back(message.drive_seq);
    if (message.drive_seq < 3) {
      bus.publish("DRIVE", drive(message.drive_seq + 1));
    }
    within = false;
  });
  bus.publish("DRIVE", drive(1));
  at_once.deliver();
  EXPECT_EQ(got_, (std::vector<std::int64_t>{1, 2, 3}));
}

TEST_F(LoopBusTest, WhoHasLeftHearsNothing) {
  auto leaving = std::make_unique<LoopBus>(network_);
  note(*leaving);
  note(receiver_);
  sender_.publish("DRIVE", drive(1));
  leaving.reset();  // with a message under way
  network_.set_time(1000);
  network_.deliver();
  EXPECT_EQ(got_, (std::vector<std::int64_t>{1}));
}

TEST_F(LoopBusTest, CountsAndDropsWhatIsNoMessageOfTheType) {
  note(receiver_);
  sender_.publish("DRIVE", nodmap::save_request_t{});
  network_.set_time(1000);
  network_.deliver();
  EXPECT_TRUE(got_.empty());
  EXPECT_EQ(receiver_.counts().corrupt, 1);
}

TEST_F(LoopBusTest, AnExceptionComesOutAndTheNextMessageIsDelivered) {
  receiver_.subscribe<nodmap::drive_t>("DRIVE", [this](const nodmap::drive_t& message) {
    if (message.drive_seq == 1) {
      throw std::runtime_error("no");
    }
    got_.push_back(message.drive_seq);
  });
  sender_.publish("DRIVE", drive(1));
  sender_.publish("DRIVE", drive(2));
  network_.set_time(1000);
  EXPECT_THROW(network_.deliver(), std::runtime_error);
  network_.deliver();
  EXPECT_EQ(got_, (std::vector<std::int64_t>{2}));
}

TEST_F(LoopBusTest, LogsEverythingWhenItWasSent) {
  network_.set_time(7);
  sender_.publish("DRIVE", drive(1));
  network_.set_time(8);
  sender_.publish("NOBODY", drive(2));
  ASSERT_TRUE(network_.flush());
  LogReader reader(log_);
  const LogEvent* event = reader.next();
  ASSERT_NE(event, nullptr);
  EXPECT_EQ(event->log_utime_us, 7);
  EXPECT_EQ(event->channel, "DRIVE");
  event = reader.next();
  ASSERT_NE(event, nullptr);
  EXPECT_EQ(event->log_utime_us, 8);
  EXPECT_EQ(event->channel, "NOBODY");
  EXPECT_EQ(reader.next(), nullptr);
}

}  // namespace
}  // namespace nodmap::bus
