// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <net/if.h>

#include <bit>

#include "tools/doctor/channel_loads.hpp"

namespace nodmap::doctor {
namespace network_test {

using ::testing::HasSubstr;

static_assert(std::endian::native == std::endian::little, "the texts below are from such hosts");

constexpr const char* kHeader =
    "Iface\tDestination\tGateway \tFlags\tRefCnt\tUse\tMetric\tMask\t\tMTU\tWindow\tIRTT\n";
// From a machine with one network card, and from one after `ip route add 224.0.0.0/4 dev lo`.
constexpr const char* kDefaultRoute =
    "eth0\t00000000\t010200C0\t0003\t0\t0\t0\t00000000\t0\t0\t0\n"
    "eth0\t000200C0\t00000000\t0001\t0\t0\t0\t00FFFFFF\t0\t0\t0\n";
constexpr const char* kMulticastRoute =
    "lo\t000000E0\t00000000\t0001\t0\t0\t0\t000000F0\t0\t0\t0\n";
const std::map<std::string, unsigned int> kInterfaces{{"lo", IFF_UP | IFF_LOOPBACK},
                                                      {"eth0", IFF_UP | IFF_MULTICAST}};

std::string routes(const std::string& lines) {
  return kHeader + lines;
}

TEST(MulticastRoute, ARouteOfItsOwnIsOk) {
  const Finding finding =
      check_multicast_route(routes(std::string(kDefaultRoute) + kMulticastRoute), {}, kInterfaces);
  EXPECT_EQ(finding.status, Status::kOk);
  EXPECT_THAT(finding.sentence, HasSubstr("over lo")) << "the more specific route";
  EXPECT_TRUE(finding.command.empty());
}

TEST(MulticastRoute, TheDefaultRouteIsAWarningBecauseItFailsWithoutACable) {
  const Finding finding = check_multicast_route(routes(kDefaultRoute), {}, kInterfaces);
  EXPECT_EQ(finding.status, Status::kWarn);
  EXPECT_THAT(finding.sentence, HasSubstr("eth0"));
}

TEST(MulticastRoute, AMissingRouteFailsAndTheFixIsNamed) {
  for (const std::string& text :
       {routes(""), std::string(), std::string("nonsense\nlo x y z 1 2 3 4\n"),
        routes("eth0\t000200C0\t00000000\t0001\t0\t0\t0\t00FFFFFF\t0\t0\t0\n")}) {
    const Finding finding = check_multicast_route(text, {}, kInterfaces);
    EXPECT_EQ(finding.status, Status::kFail) << text;
    EXPECT_EQ(finding.command,
              "sudo ip link set lo multicast on; sudo ip route add 224.0.0.0/4 dev lo");
  }
}

TEST(MulticastRoute, ARouteThatIsDownOrRejectsCountsAsMissing) {
  for (const char* flags : {"0000", "0201"}) {
    const std::string line =
        std::string("lo\t000000E0\t00000000\t") + flags + "\t0\t0\t0\t000000F0\t0\t0\t0\n";
    EXPECT_EQ(check_multicast_route(routes(line), {}, kInterfaces).status, Status::kFail);
  }
}

TEST(MulticastRoute, TheInterfaceMustBeUpAndSupportMulticast) {
  const Finding down = check_multicast_route(routes(kMulticastRoute), {}, {{"lo", IFF_LOOPBACK}});
  EXPECT_EQ(down.status, Status::kFail);
  EXPECT_EQ(down.command, "sudo ip link set lo up");
  const Finding deaf = check_multicast_route(routes(kDefaultRoute), {}, {{"eth0", IFF_UP}});
  EXPECT_EQ(deaf.status, Status::kFail);
  EXPECT_EQ(deaf.command, "sudo ip link set eth0 multicast on");
}

TEST(ReceiveBuffer, IsComparedWithTheRatesOfOurChannels) {
  const auto status = [](std::int64_t bytes) {
    return check_rmem_default(std::to_string(bytes) + "\n").status;
  };
  EXPECT_EQ(status(steady_buffer_bytes() - 1), Status::kFail);
  EXPECT_EQ(status(steady_buffer_bytes()), Status::kWarn);
  EXPECT_EQ(status(full_buffer_bytes() - 1), Status::kWarn);
  EXPECT_EQ(status(full_buffer_bytes()), Status::kOk);
}

TEST(ReceiveBuffer, TheDefaultOfLinuxIsTooSmallForBursts) {
  const Finding finding = check_rmem_max("212992\n");
  EXPECT_EQ(finding.status, Status::kWarn);
  EXPECT_THAT(finding.command, HasSubstr("sudo sysctl -w net.core.rmem_max=2097152"));
  EXPECT_EQ(check_rmem_max("2097152\n").status, Status::kOk) << "the advised value is enough";
  EXPECT_EQ(check_rmem_max("").status, Status::kWarn);
  EXPECT_EQ(check_rmem_max("many\n").status, Status::kWarn);
}

// From a machine with a process on port 7699 (1E13 hex) and its sending socket; the drops are
// invented.
constexpr const char* kSockets =
    "   sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout "
    "inode ref pointer drops            \n"
    " 2001: 00000000:1E13 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 "
    "41173 2 00000000e4c54204 12        \n"
    " 2010: 00000000:DE1C 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 "
    "41172 2 000000004d2833b4 0         \n";

TEST(Sockets, AreReadFromTheKernelsTable) {
  const std::vector<UdpSocket> sockets = parse_udp_sockets(kSockets);
  ASSERT_EQ(sockets.size(), 2U);
  EXPECT_EQ(sockets[0].port, 7699);
  EXPECT_EQ(sockets[0].inode, 41173U);
  EXPECT_EQ(sockets[0].drops, 12);
  EXPECT_EQ(sockets[1].port, 0xDE1C);
  EXPECT_TRUE(parse_udp_sockets("").empty());
  EXPECT_TRUE(parse_udp_sockets("a b c d e f g h i j k l m n\n").empty());
}

TEST(Sockets, OtherProcessesOnThePortAreNamed) {
  const auto sockets = parse_udp_sockets(kSockets);
  EXPECT_EQ(check_port_users(sockets, {{41173, "nodmap-slam2d (7)"}}, 7699).status, Status::kOk);
  EXPECT_EQ(check_port_users(sockets, {}, 7667).status, Status::kOk);
  const Finding other = check_port_users(sockets, {{41173, "game (9)"}}, 7699);
  EXPECT_EQ(other.status, Status::kWarn);
  EXPECT_THAT(other.sentence, HasSubstr("game (9)"));
  EXPECT_THAT(check_port_users(sockets, {}, 7699).sentence, HasSubstr("another user"));
}

TEST(Sockets, SocketsThatLostDatagramsAreNamed) {
  const auto sockets = parse_udp_sockets(kSockets);
  EXPECT_EQ(check_drops(sockets, {}, 7667).status, Status::kOk);
  const Finding finding = check_drops(sockets, {{41173, "nodmap-slam2d (7)"}}, 7699);
  EXPECT_EQ(finding.status, Status::kWarn);
  EXPECT_THAT(finding.sentence, HasSubstr("12 datagrams"));
  EXPECT_THAT(finding.sentence, HasSubstr("nodmap-slam2d"));
}

TEST(SelfTestFinding, DistinguishesTheThreeOutcomes) {
  const std::string url = "udpm://239.255.76.67:7667?ttl=0";
  EXPECT_EQ(check_self_test({}, url).status, Status::kFail);
  EXPECT_THAT(check_self_test({}, url).command, HasSubstr("ip route add"));
  EXPECT_THAT(check_self_test({}, "nonsense").command, HasSubstr("LCM_DEFAULT_URL"));
  SelfTest test;
  test.opened = true;
  EXPECT_EQ(check_self_test(test, url).status, Status::kFail);
  test.latency_ms = 0.4;
  EXPECT_EQ(check_self_test(test, url).status, Status::kOk);
}

TEST(Traffic, TrafficOfOthersIsReportedAndAnotherPortIsSuggested) {
  EXPECT_EQ(check_traffic({}, {1, 2}, {}).status, Status::kOk);
  EXPECT_EQ(check_traffic({{"SCAN", 1, 75}}, {1, 2}, {}).status, Status::kOk);
  const Finding foreign = check_traffic({{"SCAN", 1, 75}, {"CAMERA", 9, 30}}, {1, 2}, {});
  EXPECT_EQ(foreign.status, Status::kWarn);
  EXPECT_THAT(foreign.sentence, HasSubstr("30 messages"));
  EXPECT_THAT(foreign.sentence, HasSubstr("CAMERA"));
  EXPECT_EQ(foreign.command, "export LCM_DEFAULT_URL='udpm://239.255.76.67:7668?ttl=0'");
}

TEST(Silence, IsBrokenByMessagesOfAnyType) {
  EXPECT_EQ(check_silence({}, {}).status, Status::kOk);
  const Finding finding = check_silence({{"STATUS", 1, 2}, {"CAMERA", 9, 30}}, {});
  EXPECT_EQ(finding.status, Status::kFail);
  EXPECT_THAT(finding.sentence, HasSubstr("CAMERA, STATUS"));
  EXPECT_THAT(finding.command, HasSubstr(":7668")) << "another port";
}

TEST(TrustedHosts, WarnsIfTheUrlReachesOtherHostsAndNoneIsTrusted) {
  EXPECT_EQ(check_trusted_hosts("", {}).status, Status::kOk);
  bus::UdpmUrl network;
  network.ttl = 1;
  EXPECT_EQ(check_trusted_hosts("", network).status, Status::kWarn);
  EXPECT_EQ(check_trusted_hosts("10.0.0.2", network).status, Status::kOk);
  EXPECT_EQ(check_trusted_hosts("0.0.0.0/0", network).status, Status::kWarn);
  EXPECT_EQ(check_trusted_hosts("mapper", network).status, Status::kFail);
}

}  // namespace network_test
}  // namespace nodmap::doctor
