// SPDX-License-Identifier: BSD-3-Clause
// Findings about the network, each a function of what was read from the system.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/bus/udpm_url.hpp"
#include "tools/doctor/finding.hpp"

namespace nodmap::doctor {

/// Whether a packet to the group finds a way out. `proc_net_route` is the text of /proc/net/route,
/// `interface_flags` the flags (net/if.h) of each interface by name.
[[nodiscard]] Finding check_multicast_route(
    const std::string& proc_net_route, const bus::UdpmUrl& url,
    const std::map<std::string, unsigned int>& interface_flags);

/// Whether sockets hold what we send (channel_loads.hpp). The texts are those of
/// /proc/sys/net/core/rmem_default and rmem_max.
[[nodiscard]] Finding check_rmem_default(const std::string& text);
[[nodiscard]] Finding check_rmem_max(const std::string& text);

struct UdpSocket {
  std::uint16_t port = 0;
  std::uint64_t inode = 0;
  std::int64_t drops = 0;  ///< datagrams that found its buffer full
};

/// The sockets in the text of /proc/net/udp; lines that cannot be read are left out.
[[nodiscard]] std::vector<UdpSocket> parse_udp_sockets(const std::string& proc_net_udp);

/// Who else listens on the port. `owners` names the process of a socket by inode, where known.
[[nodiscard]] Finding check_port_users(const std::vector<UdpSocket>& sockets,
                                       const std::map<std::uint64_t, std::string>& owners,
                                       std::uint16_t port);

/// Whether running processes have lost messages in their sockets.
[[nodiscard]] Finding check_drops(const std::vector<UdpSocket>& sockets,
                                  const std::map<std::uint64_t, std::string>& owners,
                                  std::uint16_t port);

/// What came over a channel while the doctor listened.
struct HeardChannel {
  std::string channel;
  std::int64_t fingerprint = 0;
  std::int64_t count = 0;
};

/// The outcome of sending a message and waiting for it.
struct SelfTest {
  bool opened = false;
  std::optional<double> latency_ms;  ///< empty when the message did not come back in time
  std::vector<HeardChannel> heard;   ///< other messages
};

[[nodiscard]] Finding check_self_test(const SelfTest& test, const std::string& url);

/// Whether others use the port: LCM 1.3.1 binds to every address, so that it hears all multicast
/// groups of its port.
[[nodiscard]] Finding check_traffic(const std::vector<HeardChannel>& heard,
                                    const std::set<std::int64_t>& our_fingerprints,
                                    const bus::UdpmUrl& url);

/// Whose messages are taken. `trusted_hosts` is what $NODMAP_TRUSTED_HOSTS says.
[[nodiscard]] Finding check_trusted_hosts(const std::string& trusted_hosts,
                                          const bus::UdpmUrl& url);

}  // namespace nodmap::doctor
