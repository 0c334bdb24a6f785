// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace nodmap::bus {

/// An IPv4 address as a number, the first octet highest, as text.
[[nodiscard]] std::string address_text(std::uint32_t address);

/// The IPv4 addresses of this host's interfaces.
[[nodiscard]] std::vector<std::uint32_t> addresses_of_this_host();

/// Whose datagrams are taken: those of this host, and those of the hosts that are named. ttl=0
/// keeps our messages on the host; it keeps nobody else's out.
///
/// This host's messages bear an address of one of its interfaces, or 0.0.0.0 when multicast goes
/// over the loopback. Nobody else's can: Linux drops what comes from outside with such a source (as
/// "martian") before a socket sees it. The addresses of other hosts can be forged by whoever
/// is on the same network.
class TrustedHosts {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// `hosts`: addresses and networks, separated by commas: "10.0.0.2,10.0.1.0/24". Throws
  /// std::runtime_error that names the part it cannot read. `own_addresses` is asked again, once a
  /// second at most, when an unknown address appears: interfaces come and go.
  explicit TrustedHosts(
      const std::string& hosts,
      std::function<std::vector<std::uint32_t>()> own_addresses = &addresses_of_this_host);

  [[nodiscard]] bool contains(std::uint32_t address, Time now);

 private:
  struct Network {
    std::uint32_t address = 0;
    std::uint32_t mask = 0;
  };

  [[nodiscard]] bool is_known(std::uint32_t address) const;

  std::vector<Network> networks_;
  std::function<std::vector<std::uint32_t>()> own_addresses_;
  std::vector<std::uint32_t> own_;
  std::optional<Time> asked_at_;
};

}  // namespace nodmap::bus
