// SPDX-License-Identifier: BSD-3-Clause
// LCM 1.3.1's traps, each with a test. memq:// stays within one object: no network.
#include "common/bus/live_bus.hpp"

#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <random>
#include <stdexcept>

#include "common/formats/user_error.hpp"

namespace nodmap::bus {
namespace live_bus_test {

using std::chrono::milliseconds;

nodmap::odometry_t odometry_at(std::int64_t utime) {
  nodmap::odometry_t message{};
  message.utime = utime;
  return message;
}

void handle_all(LiveBus& bus) {
  while (bus.handle(milliseconds(0)) > 0) {
  }
}

TEST(LiveBus, DeliversTypedMessages) {
  LiveBus bus("memq://");
  std::int64_t seen = 0;
  bus.subscribe<nodmap::odometry_t>("ODOMETRY",
                                    [&](const nodmap::odometry_t& m) { seen = m.utime; });
  bus.publish("ODOMETRY", odometry_at(42));
  handle_all(bus);
  EXPECT_EQ(seen, 42);
  EXPECT_EQ(bus.counts().received, 1);
  EXPECT_EQ(bus.counts().published, 1);
  EXPECT_EQ(bus.latency().summary().count, 1);
}

// There is no socket.
TEST(LiveBus, TheSenderOfAMessageInMemoryIsUnknown) {
  LiveBus bus("memq://");
  Origin origin{{1, 1}, {}};
  bus.subscribe<nodmap::odometry_t>("ODOMETRY",
                                    [&](const nodmap::odometry_t&) { origin = bus.origin(); });
  bus.publish("ODOMETRY", odometry_at(1));
  handle_all(bus);
  EXPECT_EQ(origin.sender, Sender{});
  EXPECT_GT(origin.received, time::Timestamp{});
  EXPECT_GT(origin.arrived, time::SteadyTime{});
}

// Trap: the channel given to subscribe is a regular expression.
TEST(LiveBus, ChannelNamesAreNotPatterns) {
  LiveBus bus("memq://");
  int seen = 0;
  for (const char* channel : {"LASER.1", "A|B", "X*", "P[0]", "Q(1)", "R\\d", "S+", "T?", "^U$"}) {
    bus.subscribe<nodmap::odometry_t>(channel, [&](const nodmap::odometry_t&) { ++seen; });
  }
  for (const char* channel : {"LASER_1", "A", "B", "X", "XX", "P0", "Q1", "R7", "SS", "S", "U"}) {
    bus.publish(channel, odometry_at(1));
  }
  handle_all(bus);
  EXPECT_EQ(seen, 0);
  for (const char* channel : {"LASER.1", "A|B", "X*", "P[0]", "Q(1)", "R\\d", "S+", "T?", "^U$"}) {
    bus.publish(channel, odometry_at(1));
  }
  handle_all(bus);
  EXPECT_EQ(seen, 9);
}

// Trap: an exception that leaves a handler makes the next lcm_handle() abort the process.
TEST(LiveBus, AnExceptionLeavesHandleAndTheBusStaysUsable) {
  LiveBus bus("memq://");
  int seen = 0;
  bus.subscribe<nodmap::odometry_t>("ODOMETRY", [&](const nodmap::odometry_t& message) {
    ++seen;
    if (message.utime == 1) {
      throw std::runtime_error("broken");
    }
  });
  bus.publish("ODOMETRY", odometry_at(1));
  EXPECT_THROW(bus.handle(milliseconds(0)), std::runtime_error);
  bus.publish("ODOMETRY", odometry_at(2));
  handle_all(bus);
  EXPECT_EQ(seen, 2);
}

// Trap: the generated decoders allocate what a count claims, or throw.
TEST(LiveBus, CorruptMessagesAreCountedAndDropped) {
  LiveBus bus("memq://");
  int seen = 0;
  bus.subscribe<nodmap::scan_t>("SCAN", [&](const nodmap::scan_t&) { ++seen; });
  nodmap::scan_t scan{};
  std::vector<std::byte> bytes;
  encode_into(bytes, scan);
  std::vector<std::byte> negative_count = bytes;
  for (std::size_t i = 0; i < 4; ++i) {
    negative_count[negative_count.size() - 8 + i] = std::byte{0xFF};  // num_ranges = -1
  }
  bus.publish_bytes("SCAN", negative_count);
  bus.publish_bytes("SCAN", std::span(bytes).first(20));
  bus.publish_bytes("SCAN", {});
  bus.publish("SCAN", odometry_at(1));  // another type on this channel
  bus.publish("SCAN", scan);
  handle_all(bus);
  EXPECT_EQ(seen, 1);
  EXPECT_EQ(bus.counts().corrupt, 4);
}

// A SCAN of a million ranges is a valid message, but handling it would take too much memory in each
// process.
TEST(LiveBus, MessagesBeyondAnyOfOursAreCorrupt) {
  LiveBus bus("memq://");
  int seen = 0;
  bus.subscribe<nodmap::scan_t>("SCAN", [&](const nodmap::scan_t&) { ++seen; });
  nodmap::scan_t scan{};
  for (const int num_ranges : {60'000, 1'000'000}) {
    scan.num_ranges = num_ranges;
    scan.ranges_m.resize(static_cast<std::size_t>(num_ranges));
    bus.publish("SCAN", scan);
  }
  handle_all(bus);
  EXPECT_EQ(seen, 1);
  EXPECT_EQ(bus.counts().corrupt, 1);
}

TEST(LiveBus, AMillionRandomBytesOnScan) {
  LiveBus bus("memq://");
  int seen = 0;
  bus.subscribe<nodmap::scan_t>("SCAN", [&](const nodmap::scan_t&) { ++seen; });
  std::mt19937 random(11);
  std::vector<std::byte> noise(1'000'000);
  for (std::byte& b : noise) {
    b = static_cast<std::byte>(random() & 0xFFU);
  }
  std::int64_t sent = 0;
  for (std::size_t at = 0; at < noise.size();) {
    const std::size_t size = std::min<std::size_t>(1 + random() % 4000, noise.size() - at);
    bus.publish_bytes("SCAN", std::span(noise).subspan(at, size));
    at += size;
    ++sent;
  }
  handle_all(bus);
  EXPECT_EQ(seen, 0);
  EXPECT_EQ(bus.counts().corrupt, sent);
}

// Trap: a full queue drops the NEWEST message, so that a queue of 1 holds the oldest.
TEST(LiveBus, LatestHoldsTheNewestOfABurst) {
  LiveBus bus("memq://");
  const Latest<nodmap::odometry_t> latest(bus, "ODOMETRY");
  EXPECT_FALSE(latest.get().has_value());
  for (int i = 1; i <= 50; ++i) {
    bus.publish("ODOMETRY", odometry_at(i));
  }
  handle_all(bus);
  ASSERT_TRUE(latest.get().has_value());
  EXPECT_EQ(latest.get()->utime, 50);
  EXPECT_EQ(latest.count(), 50);
}

TEST(HandleLimit, AdmitsSoManyMessages) {
  HandleLimit dut;
  for (int i = 0; i < HandleLimit::kMaxMessages; ++i) {
    EXPECT_TRUE(dut.admits_another(time::SteadyTime{}));
  }
  EXPECT_FALSE(dut.admits_another(time::SteadyTime{}));
}

TEST(HandleLimit, AdmitsMessagesForSoLongAfterTheFirst) {
  const time::SteadyTime first{24h};
  HandleLimit dut;
  EXPECT_TRUE(dut.admits_another(first));
  EXPECT_TRUE(dut.admits_another(first + HandleLimit::kMaxTime - 1us));
  EXPECT_FALSE(dut.admits_another(first + HandleLimit::kMaxTime));
}

TEST(LiveBus, HandleReturnsDuringAFlood) {
  LiveBus bus("memq://");
  bus.subscribe<nodmap::odometry_t>("ECHO", [&](const nodmap::odometry_t& message) {
    bus.publish("ECHO", message);  // each message causes the next
  });
  bus.publish("ECHO", odometry_at(1));
  const int handled = bus.handle(milliseconds(0));
  EXPECT_GE(handled, 1);  // fewer than the most if they take long
  EXPECT_LE(handled, HandleLimit::kMaxMessages);
}

// The caller has a STATUS to publish and signals to obey.
TEST(LiveBus, HandleReturnsWhenHandlersHaveTakenLong) {
  LiveBus bus("memq://");
  int seen = 0;
  bus.subscribe<nodmap::odometry_t>("ODOMETRY", [&](const nodmap::odometry_t&) {
    ++seen;
    const auto end = time::steady_now() + HandleLimit::kMaxTime;
    while (time::steady_now() < end) {
    }
  });
  for (int i = 1; i <= 3; ++i) {
    bus.publish("ODOMETRY", odometry_at(i));
  }
  for (int i = 1; i <= 3; ++i) {
    EXPECT_EQ(bus.handle(milliseconds(0)), 1);
    EXPECT_EQ(seen, i);
  }
}

TEST(LiveBus, ThePollHandleSignalsAWaitingMessage) {
  LiveBus bus("memq://");
  bus.subscribe<nodmap::odometry_t>("ODOMETRY", [](const nodmap::odometry_t&) {});
  pollfd entry{bus.poll_handle(), POLLIN, 0};
  EXPECT_EQ(::poll(&entry, 1, 0), 0);
  bus.publish("ODOMETRY", odometry_at(1));
  EXPECT_EQ(::poll(&entry, 1, 0), 1);
  handle_all(bus);
  EXPECT_EQ(::poll(&entry, 1, 0), 0);
}

TEST(LiveBus, AUrlThatCannotWorkIsAnError) {
  EXPECT_THROW(LiveBus("nonsense://"), std::runtime_error);
  EXPECT_THROW(LiveBus("udpm://239.255.76.67:7667?tttl=1"), formats::UserError);
}

// LCM itself would abort.
TEST(LiveBus, AServerThatIsMissingIsAnError) {
  LiveBus bus("tcpq://127.0.0.1:1");
  EXPECT_THROW(bus.handle(milliseconds(0)), std::runtime_error);
  EXPECT_THROW((void)bus.poll_handle(), std::runtime_error);
}

TEST(LiveBus, UrlComesFromTheOptionThenTheEnvironment) {
  EXPECT_EQ(resolve_url("memq://x"), "memq://x");
  ::setenv("LCM_DEFAULT_URL", "memq://y", 1);
  EXPECT_EQ(resolve_url(""), "memq://y");
  ::setenv("LCM_DEFAULT_URL", "memq://", 1);  // as ctest sets it
}

}  // namespace live_bus_test
}  // namespace nodmap::bus
