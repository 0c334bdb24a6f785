// SPDX-License-Identifier: BSD-3-Clause
// What somebody on the network can do with single datagrams: nodmap-logger hears every channel, so
// it stands for all that receive. Run by tests/support/private_network.sh, whose user may forge
// sources.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <map>

#include "common/bus/event_log.hpp"
#include "common/bus/live_bus.hpp"
#include "nodmap/status_t.hpp"
#include "tests/integration/child_process.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap {
namespace {

using std::chrono::milliseconds;

constexpr const char* kUrl = "udpm://239.255.76.67:7692?ttl=0&recv_buf_size=4000000";
constexpr const char* kGroup = "239.255.76.67";
constexpr std::uint16_t kPort = 7692;
constexpr milliseconds kPatience(10'000);  // for what takes milliseconds, on a machine in use

std::string big_endian(std::uint32_t value, int size) {
  std::string bytes;
  for (int i = size - 1; i >= 0; --i) {
    bytes += static_cast<char>(value >> (8 * i) & 0xFFU);
  }
  return bytes;
}

std::string whole(const std::string& channel_and_data) {
  return "LC02" + big_endian(0, 4) + channel_and_data;
}

std::string fragment(std::uint32_t message_bytes, std::uint32_t offset, std::uint32_t number,
                     const std::string& payload) {
  return "LC03" + big_endian(0, 4) + big_endian(message_bytes, 4) + big_endian(offset, 4) +
         big_endian(number, 2) + big_endian(2, 2) + payload;
}

sockaddr_in address_of(const char* host, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  EXPECT_EQ(::inet_pton(AF_INET, host, &address.sin_addr), 1);
  return address;
}

/// Sends bytes to the group as they are: as a datagram of this host, or in an IP packet whose
/// source says that it comes from another.
class Attacker {
 public:
  ~Attacker() {
    ::close(udp_);
    ::close(raw_);
  }
  Attacker() = default;
  Attacker(const Attacker&) = delete;
  Attacker& operator=(const Attacker&) = delete;
  Attacker(Attacker&&) = delete;
  Attacker& operator=(Attacker&&) = delete;

  void send(const std::string& datagram) const { send_on(udp_, datagram); }

  void send_as(const char* source, const std::string& datagram) const {
    udphdr udp{};
    udp.source = htons(40'000);
    udp.dest = htons(kPort);
    udp.len = htons(static_cast<std::uint16_t>(sizeof(udp) + datagram.size()));
    iphdr ip{};  // the kernel fills in length and checksum
    ip.version = 4;
    ip.ihl = 5;
    ip.ttl = 1;
    ip.protocol = IPPROTO_UDP;
    ip.saddr = address_of(source, 0).sin_addr.s_addr;
    ip.daddr = group_.sin_addr.s_addr;
    std::string packet(sizeof(ip) + sizeof(udp), '\0');
    std::memcpy(packet.data(), &ip, sizeof(ip));
    std::memcpy(packet.data() + sizeof(ip), &udp, sizeof(udp));
    send_on(raw_, packet + datagram);
  }

 private:
  void send_on(int socket, const std::string& bytes) const {
    EXPECT_EQ(::sendto(socket, bytes.data(), bytes.size(), 0,
                       reinterpret_cast<const sockaddr*>(&group_), sizeof(group_)),
              static_cast<ssize_t>(bytes.size()))
        << std::strerror(errno);
  }

  sockaddr_in group_ = address_of(kGroup, kPort);
  int udp_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  int raw_ = ::socket(AF_INET, SOCK_RAW | SOCK_CLOEXEC, IPPROTO_RAW);
};

class HostileNetwork : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_NE(std::getenv("NODMAP_LOGGER"), nullptr) << "set by ctest"; }
  void TearDown() override { ::unsetenv("NODMAP_TRUSTED_HOSTS"); }

  /// A logger hears what `attack` sends, then a message of ours, and is asked to end. How many
  /// messages of each channel it has recorded.
  template <class Attack>
  std::map<std::string, int> record(Attack attack) {
    test::ChildProcess logger({std::getenv("NODMAP_LOGGER"), "--lcm-url", kUrl, "--out",
                               dir_.path().string(), "--file", "log"});
    EXPECT_TRUE(logger.wait_for_stderr("listening", kPatience)) << logger.said();
    attack();
    bus_.publish_bytes("OURS", std::as_bytes(std::span("data")));
    // Once a second: by then all that was sent before has been taken.
    const std::int64_t told = status_.count();
    for (int i = 0; i < 100 && status_.count() < told + 2; ++i) {
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
  Attacker attacker_;
  bus::LiveBus bus_{kUrl};
  bus::Latest<nodmap::status_t> status_{bus_, "STATUS"};
};

// liblcm 1.3.1 and 1.5.2 write 260 bytes in front of the message's 1000: offset + size wraps to 4.
TEST_F(HostileNetwork, TwoFragmentsDoNotEndAProcess) {
  const std::map<std::string, int> recorded = record([&] {
    attacker_.send(fragment(1000, 0, 0, std::string("SCAN\0", 5)));
    attacker_.send(fragment(1000, 0xFFFFFF00, 1, std::string(260, 'x')));
  });
  EXPECT_EQ(recorded.count("SCAN"), 0U);
  EXPECT_EQ(recorded.at("OURS"), 1);
  EXPECT_GT(status_.get()->total_corrupt, 0);
}

// liblcm takes the data of such a datagram for 2^32 - 1 bytes long.
TEST_F(HostileNetwork, AChannelWithoutEndDoesNotEndALogger) {
  const std::map<std::string, int> recorded = record([&] { attacker_.send(whole("SCAN")); });
  EXPECT_EQ(recorded.count("SCAN"), 0U);
  EXPECT_EQ(recorded.at("OURS"), 1);
}

TEST_F(HostileNetwork, AnotherHostIsNotHeardAndIsNamed) {
  const std::map<std::string, int> recorded =
      record([&] { attacker_.send_as("10.9.9.9", whole(std::string("DRIVE\0data", 10))); });
  EXPECT_EQ(recorded.count("DRIVE"), 0U);
  EXPECT_EQ(recorded.at("OURS"), 1);
  EXPECT_GT(status_.get()->total_rejected, 0);
}

TEST_F(HostileNetwork, AHostThatIsTrustedIsHeard) {
  ::setenv("NODMAP_TRUSTED_HOSTS", "10.9.9.0/24", 1);
  const std::map<std::string, int> recorded =
      record([&] { attacker_.send_as("10.9.9.9", whole(std::string("DRIVE\0data", 10))); });
  EXPECT_EQ(recorded.at("DRIVE"), 1);
}

// Our own sender, and fragments as the kernel delivers them.
TEST_F(HostileNetwork, ALargeMessageComesWhole) {
  std::vector<std::byte> large(200'000);
  for (std::size_t i = 0; i < large.size(); ++i) {
    large[i] = static_cast<std::byte>(i * 7 % 251);
  }
  std::vector<std::byte> heard;
  bus_.subscribe_bytes(
      "LARGE", [&](std::span<const std::byte> bytes) { heard.assign(bytes.begin(), bytes.end()); });
  bus_.publish_bytes("LARGE", large);
  EXPECT_EQ(bus_.handle(kPatience), 1);
  EXPECT_EQ(heard, large);
}

// What a robot that has fallen behind needs is what is new.
TEST_F(HostileNetwork, AFullQueueDropsItsOldestMessages) {
  std::vector<int> heard;
  bus_.subscribe_bytes(
      "COUNT",
      [&](std::span<const std::byte> bytes) { heard.push_back(std::to_integer<int>(bytes[0])); },
      4);
  for (int i = 0; i < 100; ++i) {
    bus_.publish_bytes("COUNT", std::vector<std::byte>{static_cast<std::byte>(i)});
  }
  const auto start = std::chrono::steady_clock::now();
  while (bus_.counts().overrun < 96 && std::chrono::steady_clock::now() - start < kPatience) {
    ::sched_yield();
  }
  EXPECT_EQ(bus_.handle(milliseconds(0)), 4);
  EXPECT_EQ(heard, (std::vector<int>{96, 97, 98, 99}));
}

}  // namespace
}  // namespace nodmap
