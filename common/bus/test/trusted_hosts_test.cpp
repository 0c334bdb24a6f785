// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/trusted_hosts.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "common/formats/user_error.hpp"

namespace nodmap::bus {
namespace trusted_hosts_test {

using std::chrono::milliseconds;

constexpr std::uint32_t address(std::uint32_t a, std::uint32_t b, std::uint32_t c,
                                std::uint32_t d) {
  return a << 24U | b << 16U | c << 8U | d;
}

constexpr time::SteadyTime kStart{};

TEST(TrustedHosts, ThisHostAlwaysAndOthersOnlyByName) {
  TrustedHosts alone("", [] { return std::vector{address(10, 0, 0, 1)}; });
  EXPECT_TRUE(alone.contains(address(127, 0, 0, 1), kStart));
  EXPECT_TRUE(alone.contains(address(0, 0, 0, 0), kStart));
  EXPECT_TRUE(alone.contains(address(10, 0, 0, 1), kStart));
  EXPECT_FALSE(alone.contains(address(10, 0, 0, 2), kStart));

  TrustedHosts with_others("10.0.0.2,10.1.0.0/16", [] { return std::vector<std::uint32_t>(); });
  EXPECT_TRUE(with_others.contains(address(10, 0, 0, 2), kStart));
  EXPECT_TRUE(with_others.contains(address(10, 1, 255, 3), kStart));
  EXPECT_FALSE(with_others.contains(address(10, 0, 0, 3), kStart));
  EXPECT_FALSE(with_others.contains(address(10, 2, 0, 1), kStart));

  TrustedHosts network_of_a_host("10.1.2.3/16", [] { return std::vector<std::uint32_t>(); });
  EXPECT_TRUE(network_of_a_host.contains(address(10, 1, 255, 3), kStart));
  EXPECT_FALSE(network_of_a_host.contains(address(10, 2, 2, 3), kStart));

  TrustedHosts everybody("0.0.0.0/0", [] { return std::vector<std::uint32_t>(); });
  EXPECT_TRUE(everybody.contains(address(192, 168, 0, 1), kStart));
}

TEST(TrustedHosts, AnInterfaceThatGetsItsAddressLaterIsKnownWithinASecond) {
  int asked = 0;
  std::vector<std::uint32_t> own;
  TrustedHosts hosts("", [&] {
    ++asked;
    return own;
  });
  EXPECT_FALSE(hosts.contains(address(10, 0, 0, 1), kStart));
  own = {address(10, 0, 0, 1)};
  for (int i = 0; i < 1000; ++i) {  // a flood of strangers does not ask the kernel each time
    EXPECT_FALSE(hosts.contains(address(10, 0, 0, 9), kStart + milliseconds(i)));
  }
  EXPECT_EQ(asked, 1);
  EXPECT_TRUE(hosts.contains(address(10, 0, 0, 1), kStart + milliseconds(1000)));
}

// Another host may have it by now.
TEST(TrustedHosts, AnAddressThatThisHostHasLostIsForgottenWithinASecond) {
  std::vector<std::uint32_t> own{address(10, 0, 0, 1)};
  TrustedHosts hosts("", [&] { return own; });
  EXPECT_TRUE(hosts.contains(address(10, 0, 0, 1), kStart));
  own = {address(10, 0, 0, 7)};
  EXPECT_FALSE(hosts.contains(address(10, 0, 0, 1), kStart + milliseconds(1000)));
  EXPECT_TRUE(hosts.contains(address(10, 0, 0, 7), kStart + milliseconds(1000)));
}

// Without a file descriptor left, for example: the robot's own messages must not be refused then.
TEST(TrustedHosts, AQuestionThatFailsForgetsNoAddress) {
  std::optional<std::vector<std::uint32_t>> own{{address(10, 0, 0, 1)}};
  TrustedHosts hosts("", [&] { return own; });
  EXPECT_TRUE(hosts.contains(address(10, 0, 0, 1), kStart));
  own.reset();
  EXPECT_TRUE(hosts.contains(address(10, 0, 0, 1), kStart + milliseconds(1000)));
  own = {address(10, 0, 0, 7)};
  EXPECT_FALSE(hosts.contains(address(10, 0, 0, 1), kStart + milliseconds(2000)));
}

TEST(TrustedHosts, AnInvalidAddressIsAnError) {
  for (const char* text : {"robot", "10.0.0", "10.0.0.2/33", "10.0.0.2/", "10.0.0.2/-1",
                           "10.0.0.256", "10.0.0.0/24x", ","}) {
    EXPECT_THROW(TrustedHosts{text}, formats::UserError) << text;
  }
}

TEST(TrustedHosts, AddressesAsText) {
  EXPECT_EQ(address_text(address(192, 168, 0, 255)), "192.168.0.255");
}

}  // namespace trusted_hosts_test
}  // namespace nodmap::bus
