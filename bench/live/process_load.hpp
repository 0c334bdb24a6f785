// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>

namespace nodmap::bench {

/// What a process takes of the machine, as Linux counts it (proc(5)).
struct ProcessLoad {
  double cpu_s = 0.0;  ///< of all threads, in user and system, since its start
  double resident_mib = 0.0;
};

/// From a line of /proc/PID/stat; nothing when it is none. `tick_s`: the kernel's unit of time.
[[nodiscard]] std::optional<ProcessLoad> parse_load(const std::string& stat, double tick_s,
                                                    double page_bytes);

/// Nothing when there is no such process.
[[nodiscard]] std::optional<ProcessLoad> read_load(pid_t pid);

/// What the kernel holds of datagrams that nobody has fetched, and what it threw away because
/// nobody came: all UDP sockets of the network together.
struct UdpQueues {
  std::int64_t waiting_bytes = 0;
  std::int64_t dropped = 0;
};

/// From /proc/net/udp. Lines that are none are passed over.
[[nodiscard]] UdpQueues parse_udp_queues(std::istream& table);
[[nodiscard]] UdpQueues read_udp_queues();

}  // namespace nodmap::bench
