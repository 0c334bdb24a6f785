// SPDX-License-Identifier: BSD-3-Clause
// What a host on the network can do with single datagrams. nodmap-logger receives every channel, so
// it stands for all receiving processes. Run by tests/support/private_network.sh, whose user may
// forge source addresses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/socket.h>

#include <csignal>
#include <cstdlib>
#include <map>
#include <vector>

#include "common/bus/event_log.hpp"
#include "common/bus/live_bus.hpp"
#include "common/bus/udpm_receiver.hpp"
#include "common/formats/file_descriptor.hpp"
#include "nodmap/status_t.hpp"
#include "tests/support/attacker.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap {
namespace hostile_network_test {

using std::chrono::milliseconds;
using test::kPatience;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;

constexpr const char* kUrl = "udpm://239.255.76.67:7692?ttl=0&recv_buf_size=4000000";
constexpr std::uint16_t kPort = 7692;

class HostileNetwork : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_NE(std::getenv("NODMAP_LOGGER"), nullptr) << "set by ctest";
    bus_.subscribe<nodmap::status_t>(
        "STATUS", [this](const nodmap::status_t& message) { statuses_.push_back(message); });
  }
  void TearDown() override { ::unsetenv("NODMAP_TRUSTED_HOSTS"); }

  // Starts a logger, sends what `attack` sends and a message of ours, and ends the logger. Returns
  // how many messages of each channel it has recorded.
  template <class Attack>
  std::map<std::string, int> record(Attack attack) {
    test::ChildProcess logger({std::getenv("NODMAP_LOGGER"), "--lcm-url", kUrl, "--out",
                               dir_.path().string(), "--file", "log"});
    EXPECT_TRUE(logger.wait_for_stderr("listening", kPatience)) << logger.said();
    attack();
    bus_.publish_bytes("OURS", std::as_bytes(std::span("data")));
    // STATUS comes once a second: after two of them all that was sent before has been handled.
    const std::size_t told = statuses_.size();
    for (int i = 0; i < 100 && statuses_.size() < told + 2; ++i) {
      bus_.handle(milliseconds(100));
    }
    logger.send_signal(SIGTERM);
    EXPECT_EQ(logger.wait_for_end(kPatience), 0) << logger.said();
    std::map<std::string, int> recorded;
    bus::LogReader reader(dir_.path() / "log");
    while (const bus::LogEvent* event = reader.next()) {
      ++recorded[std::string(event->channel)];
    }
    return recorded;
  }

  test::TemporaryDir dir_;
  test::Attacker attacker_{kPort};
  bus::LiveBus bus_{kUrl};
  std::vector<nodmap::status_t> statuses_;
};

TEST_F(HostileNetwork, TwoOverlappingFragmentsDoNotEndTheLogger) {
  const std::map<std::string, int> recorded = record([&] {
    for (const std::string& datagram : test::two_fragments_that_wrap("SCAN")) {
      attacker_.send(datagram);
    }
  });
  EXPECT_EQ(recorded.count("SCAN"), 0U);
  EXPECT_EQ(recorded.at("OURS"), 1);
  EXPECT_GT(statuses_.back().total_corrupt, 0);
}

// liblcm assumes that the data of such a datagram are 2^32 - 1 bytes long.
TEST_F(HostileNetwork, AChannelNameWithoutAnEndDoesNotEndTheLogger) {
  const std::map<std::string, int> recorded =
      record([&] { attacker_.send(test::datagram("SCAN")); });
  EXPECT_EQ(recorded.count("SCAN"), 0U);
  EXPECT_EQ(recorded.at("OURS"), 1);
  EXPECT_GT(statuses_.back().total_corrupt, 0) << "it has arrived";
}

TEST_F(HostileNetwork, MessagesOfAnotherHostAreRefusedAndItsAddressIsReported) {
  const std::map<std::string, int> recorded = record(
      [&] { attacker_.send_as("10.9.9.9", test::datagram(std::string("DRIVE\0data", 10))); });
  EXPECT_EQ(recorded.count("DRIVE"), 0U);
  EXPECT_EQ(recorded.at("OURS"), 1);
  EXPECT_GT(statuses_.back().total_rejected, 0);
  EXPECT_THAT(statuses_,
              Contains(AllOf(Field(&nodmap::status_t::health, nodmap::status_t::DEGRADED),
                             Field(&nodmap::status_t::health_reason, HasSubstr("10.9.9.9")))));
}

TEST_F(HostileNetwork, MessagesOfATrustedHostAreRecorded) {
  ::setenv("NODMAP_TRUSTED_HOSTS", "10.9.9.0/24", 1);
  const std::map<std::string, int> recorded = record(
      [&] { attacker_.send_as("10.9.9.9", test::datagram(std::string("DRIVE\0data", 10))); });
  EXPECT_EQ(recorded.at("DRIVE"), 1);
}

// Each keeps its socket, for small messages and for large ones in fragments.
TEST_F(HostileNetwork, TheSendersOfMessagesAreKnown) {
  bus::LiveBus other(kUrl);
  std::vector<bus::Sender> senders;
  bus_.subscribe_bytes("ANY", [&](std::span<const std::byte> /*bytes*/) {
    senders.push_back(bus_.origin().sender);
  });
  for (const std::size_t size : {std::size_t{1}, std::size_t{200'000}}) {
    for (bus::LiveBus* const sender : {&bus_, &other}) {
      sender->publish_bytes("ANY", std::vector<std::byte>(size));
      EXPECT_EQ(bus_.handle(kPatience), 1);
    }
  }
  ASSERT_EQ(senders.size(), 4U);
  EXPECT_NE(senders[0], senders[1]);
  EXPECT_EQ(senders[0], senders[2]);
  EXPECT_EQ(senders[1], senders[3]);
  EXPECT_NE(senders[0].port, 0);
}

// While a sender lives, no other process can take its port, and so send as it would.
TEST_F(HostileNetwork, NobodyElseCanSendFromTheSameSocket) {
  bus_.subscribe_bytes("ANY", [](std::span<const std::byte> /*bytes*/) {});
  bus_.publish_bytes("ANY", {});
  ASSERT_EQ(bus_.handle(kPatience), 1);
  const bus::Sender own = bus_.origin().sender;
  for (const std::uint32_t address : {std::uint32_t{INADDR_ANY}, own.address}) {
    const formats::FileDescriptor thief(::socket(AF_INET, SOCK_DGRAM, 0));
    const int yes = 1;
    for (const int option : {SO_REUSEADDR, SO_REUSEPORT}) {
      ASSERT_EQ(::setsockopt(thief.get(), SOL_SOCKET, option, &yes, sizeof(yes)), 0);
    }
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(address);
    at.sin_port = htons(own.port);
    EXPECT_NE(::bind(thief.get(), reinterpret_cast<const sockaddr*>(&at), sizeof(at)), 0);
  }
}

// Sent by our own sender, in fragments as the kernel delivers them.
TEST_F(HostileNetwork, ALargeMessageArrivesComplete) {
  std::vector<std::byte> large(200'000);
  for (std::size_t i = 0; i < large.size(); ++i) {
    large[i] = static_cast<std::byte>(i * 7 % 251);
  }
  std::vector<std::byte> received;
  bus_.subscribe_bytes("LARGE", [&](std::span<const std::byte> bytes) {
    received.assign(bytes.begin(), bytes.end());
  });
  bus_.publish_bytes("LARGE", large);
  EXPECT_EQ(bus_.handle(kPatience), 1);
  EXPECT_EQ(received, large);
}

// A robot that has fallen behind needs the newest messages.
TEST_F(HostileNetwork, AFullQueueDropsItsOldestMessages) {
  std::vector<int> received;
  bus_.subscribe_bytes(
      "COUNT",
      [&](std::span<const std::byte> bytes) { received.push_back(std::to_integer<int>(bytes[0])); },
      4);
  for (int i = 0; i < 100; ++i) {
    bus_.publish_bytes("COUNT", std::vector<std::byte>{static_cast<std::byte>(i)});
  }
  const auto start = std::chrono::steady_clock::now();
  while (bus_.counts().overrun < 96 && std::chrono::steady_clock::now() - start < kPatience) {
    ::sched_yield();
  }
  EXPECT_EQ(bus_.handle(milliseconds(0)), 4);
  EXPECT_EQ(received, (std::vector<int>{96, 97, 98, 99}));
}

// 100 MB that nobody handles meanwhile. Each PACE after the first is counted as an overrun, once
// all that was sent before it has left the socket, which therefore never is full.
TEST_F(HostileNetwork, MessagesThatAreNotHandledTakeAtMost64MB) {
  std::size_t handled_bytes = 0;
  bus_.subscribe_bytes(
      "DATA", [&](std::span<const std::byte> bytes) { handled_bytes += bytes.size(); }, 3000);
  bus_.subscribe_bytes(
      "PACE", [](std::span<const std::byte> /*bytes*/) {}, 1);
  bus_.publish_bytes("PACE", {});
  const std::vector<std::byte> data(50'000);
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 2000; ++i) {
    const std::int64_t before = bus_.counts().overrun;
    bus_.publish_bytes("DATA", data);
    bus_.publish_bytes("PACE", {});
    while (bus_.counts().overrun == before &&
           std::chrono::steady_clock::now() - start < kPatience) {
      ::sched_yield();
    }
  }
  while (bus_.handle(milliseconds(0)) > 0) {
  }
  EXPECT_LE(handled_bytes, bus::UdpmReceiver::kMaxQueuedBytes);
  EXPECT_GT(handled_bytes, bus::UdpmReceiver::kMaxQueuedBytes - data.size());
}

}  // namespace hostile_network_test
}  // namespace nodmap
