// SPDX-License-Identifier: BSD-3-Clause
// Checks of the network, each a function of data read from the system.
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

/// Checks whether there is a route to the group. `proc_net_route`: the text of /proc/net/route.
/// `interface_flags`: the flags (net/if.h) of each interface by name.
[[nodiscard]] Finding check_multicast_route(
    const std::string& proc_net_route, const bus::UdpmUrl& url,
    const std::map<std::string, unsigned int>& interface_flags);

/// Check whether the buffers of sockets are large enough for our traffic (channel_loads.hpp). The
/// texts are those of /proc/sys/net/core/rmem_default and rmem_max.
[[nodiscard]] Finding check_rmem_default(const std::string& text);
[[nodiscard]] Finding check_rmem_max(const std::string& text);

struct UdpSocket {
  std::uint16_t port = 0;
  std::uint64_t inode = 0;
  std::int64_t drops = 0;  ///< datagrams dropped because its buffer was full
};

/// The sockets in the text of /proc/net/udp; invalid lines are ignored.
[[nodiscard]] std::vector<UdpSocket> parse_udp_sockets(const std::string& proc_net_udp);

/// Checks which other processes listen on the port. `owners`: the names of the sockets' processes
/// by inode, if known.
[[nodiscard]] Finding check_port_users(const std::vector<UdpSocket>& sockets,
                                       const std::map<std::uint64_t, std::string>& owners,
                                       std::uint16_t port);

/// Checks whether running processes have lost messages in their sockets.
[[nodiscard]] Finding check_drops(const std::vector<UdpSocket>& sockets,
                                  const std::map<std::uint64_t, std::string>& owners,
                                  std::uint16_t port);

/// The messages on one channel while the doctor listened.
struct ReceivedChannel {
  std::string channel;
  std::int64_t fingerprint = 0;
  std::int64_t count = 0;
};

/// The result of sending a message and waiting for it.
struct SelfTest {
  bool opened = false;
  std::optional<double> latency_ms;       ///< empty if the message was not received in time
  std::vector<ReceivedChannel> received;  ///< other messages
};

[[nodiscard]] Finding check_self_test(const SelfTest& test, const std::string& url);

/// Checks whether other programs use the port: LCM 1.3.1 binds to every address, so it receives all
/// multicast groups of its port.
[[nodiscard]] Finding check_traffic(const std::vector<ReceivedChannel>& received,
                                    const std::set<std::int64_t>& our_fingerprints,
                                    const bus::UdpmUrl& url);

/// Checks that nobody else sends on the URL. What is started on a bus in use would command the
/// robot that uses it.
[[nodiscard]] Finding check_silence(const std::vector<ReceivedChannel>& received,
                                    const bus::UdpmUrl& url);

/// Reports whose messages are accepted. `trusted_hosts`: the value of $NODMAP_TRUSTED_HOSTS.
[[nodiscard]] Finding check_trusted_hosts(const std::string& trusted_hosts,
                                          const bus::UdpmUrl& url);

}  // namespace nodmap::doctor
