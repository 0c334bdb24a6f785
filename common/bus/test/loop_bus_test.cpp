// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/loop_bus.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <set>
#include <stdexcept>
#include <vector>

#include "nodmap/drive_t.hpp"
#include "nodmap/save_request_t.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::bus {
namespace loop_bus_test {

time::Moment at(time::Duration since_start) {
  return {time::Timestamp(since_start), time::SteadyTime(1h + since_start)};
}

nodmap::drive_t drive(std::int64_t seq) {
  nodmap::drive_t message{};
  message.drive_seq = seq;
  return message;
}

class LoopBusTest : public ::testing::Test {
 protected:
  test::TemporaryDir dir_;
  std::filesystem::path log_ = dir_.path() / "loop.lcmlog";
  LoopNetwork network_{log_, {.min = 1ms}};
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
  network_.set_time(at(5ms));
  sender_.publish("DRIVE", drive(1));
  network_.deliver();
  network_.set_time(at(5999us));
  network_.deliver();
  EXPECT_TRUE(got_.empty());
  network_.set_time(at(6ms));
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
  network_.set_time(at(1ms));
  network_.deliver();
  EXPECT_EQ(got_, (std::vector<std::int64_t>{1, -2, 3}));
}

// Without a delay an answer has the same time as its question, but is delivered after the
// question's handler has returned.
TEST_F(LoopBusTest, AnAnswerWaitsUntilTheHandlerHasReturned) {
  LoopNetwork at_once(dir_.path() / "at_once.lcmlog", {});
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

// Each reader has delays of its own, and still receives everything in the order of publishing.
TEST_F(LoopBusTest, JitterDelaysEachReaderWithoutOvertaking) {
  constexpr int kMessages = 2000;
  LoopNetwork network(dir_.path() / "jitter.lcmlog", {.min = 2ms, .mean_jitter = 1ms, .seed = 1});
  LoopBus sender(network);
  LoopBus first(network);
  LoopBus second(network);
  std::array<std::vector<time::Duration>, 2> delays_of;
  time::Duration now{};
  for (int i = 0; i < 2; ++i) {
    (i == 0 ? first : second)
        .subscribe<nodmap::drive_t>("DRIVE", [&, i](const nodmap::drive_t& message) {
          auto& delays = delays_of.at(static_cast<std::size_t>(i));
          EXPECT_EQ(message.drive_seq, static_cast<std::int64_t>(delays.size()));
          delays.push_back(now - 20ms * message.drive_seq);
        });
  }
  for (; now < 20ms * (kMessages + 1); now += 100us) {
    network.set_time(at(now));
    if (now % 20ms == 0s && now < 20ms * kMessages) {
      sender.publish("DRIVE", drive(now / 20ms));
    }
    network.deliver();
  }
  EXPECT_NE(delays_of[0], delays_of[1]);
  for (const auto& delays : delays_of) {
    ASSERT_EQ(delays.size(), static_cast<std::size_t>(kMessages));
    EXPECT_GE(*std::ranges::min_element(delays), 2ms);
    EXPECT_LE(*std::ranges::max_element(delays), 12ms);
    // 2 ms + 1 ms + half a step of 0.1 ms; the mean of 2000 is uncertain by 1 ms / sqrt(2000) = 22
    // us, four times that.
    const time::FineDuration sum =
        std::accumulate(delays.begin(), delays.end(), time::FineDuration{});
    EXPECT_NEAR(sum.count() / kMessages, 3050.0, 90.0);
  }
}

TEST_F(LoopBusTest, ADestroyedBusReceivesNothing) {
  auto leaving = std::make_unique<LoopBus>(network_);
  note(*leaving);
  note(receiver_);
  sender_.publish("DRIVE", drive(1));
  leaving.reset();  // with a message under way
  network_.set_time(at(1ms));
  network_.deliver();
  EXPECT_EQ(got_, (std::vector<std::int64_t>{1}));
}

TEST_F(LoopBusTest, CountsAndDropsMessagesOfAnotherType) {
  note(receiver_);
  sender_.publish("DRIVE", nodmap::save_request_t{});
  network_.set_time(at(1ms));
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
  network_.set_time(at(1ms));
  EXPECT_THROW(network_.deliver(), std::runtime_error);
  network_.deliver();
  EXPECT_EQ(got_, (std::vector<std::int64_t>{2}));
}

TEST_F(LoopBusTest, EachBusIsASenderOfItsOwn) {
  std::vector<Origin> origins;
  receiver_.subscribe_bytes("DRIVE", [&](auto) { origins.push_back(receiver_.origin()); });
  for (LoopBus* const sender : {&sender_, &receiver_, &sender_}) {
    sender->publish("DRIVE", drive(1));
  }
  LoopBus restarted(network_);
  restarted.publish("DRIVE", drive(1));
  network_.set_time(at(1ms));
  network_.deliver();
  ASSERT_EQ(origins.size(), 4U);
  EXPECT_EQ(origins[0].sender, origins[2].sender);
  const std::set<Sender> distinct{{}, origins[0].sender, origins[1].sender, origins[3].sender};
  EXPECT_EQ(distinct.size(), 4U);
}

// As in the socket of a process that was frozen.
TEST_F(LoopBusTest, AMessageThatWaitedIsDatedWhenItCame) {
  std::vector<Origin> origins;
  receiver_.subscribe_bytes("DRIVE", [&](auto) { origins.push_back(receiver_.origin()); });
  for (const time::Duration sent : {5ms, 300ms}) {
    network_.set_time(at(sent));
    sender_.publish("DRIVE", drive(1));
  }
  network_.set_time(at(500ms));
  network_.deliver();
  ASSERT_EQ(origins.size(), 2U);
  EXPECT_EQ(origins[0].received, at(6ms).wall);
  EXPECT_EQ(origins[0].arrived, at(6ms).steady);
  EXPECT_EQ(origins[1].received, at(301ms).wall);
  EXPECT_EQ(origins[1].arrived, at(301ms).steady);
}

TEST_F(LoopBusTest, LogsEverythingWhenItWasSent) {
  network_.set_time(at(7us));
  sender_.publish("DRIVE", drive(1));
  network_.set_time(at(8us));
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

}  // namespace loop_bus_test
}  // namespace nodmap::bus
