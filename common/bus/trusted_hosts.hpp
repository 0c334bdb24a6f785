// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/time.hpp"

namespace nodmap::bus {

/// Converts an IPv4 address to text; the first octet is the most significant byte of the number.
[[nodiscard]] std::string address_text(std::uint32_t address);

/// The IPv4 addresses of this host's interfaces; nothing if the kernel does not tell.
[[nodiscard]] std::optional<std::vector<std::uint32_t>> addresses_of_this_host();

/// The hosts whose datagrams are accepted: this host, and the hosts that are named. (ttl=0 keeps
/// our messages on this host, but does not keep the messages of other hosts out.)
///
/// Datagrams of this host have the address of one of its interfaces as their source, or 0.0.0.0 if
/// multicast uses the loopback. Other hosts cannot forge this: Linux drops datagrams from outside
/// with such a source ("martians") before a socket receives them. The address of a named host can
/// be forged by any host on the same network.
class TrustedHosts {
 public:
  /// `hosts`: addresses and networks, separated by commas: "10.0.0.2,10.0.1.0/24". Throws
  /// formats::UserError, naming the part that is invalid. `own_addresses` returns the addresses of
  /// this host; because they come and go, and another host can have one next, an answer is used for
  /// a second, and longer only while there is no other.
  explicit TrustedHosts(const std::string& hosts,
                        std::function<std::optional<std::vector<std::uint32_t>>()> own_addresses =
                            &addresses_of_this_host);

  [[nodiscard]] bool contains(std::uint32_t address, time::SteadyTime now);

 private:
  struct Network {
    std::uint32_t address = 0;
    std::uint32_t mask = 0;
  };

  std::vector<Network> networks_;
  std::function<std::optional<std::vector<std::uint32_t>>()> own_addresses_;
  std::vector<std::uint32_t> own_;
  std::optional<time::SteadyTime> asked_at_;
};

}  // namespace nodmap::bus
