// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <iosfwd>
#include <optional>

namespace nodmap::bench {

/// CPU time and memory of a process, as Linux counts them (proc(5)).
struct ProcessLoad {
  double cpu_s = 0.0;  ///< of all threads, in user and system, since its start
  double resident_mib = 0.0;
};

/// Nothing if there is no such process.
[[nodiscard]] std::optional<ProcessLoad> read_load(pid_t pid);

/// Datagrams that wait in the kernel's receive queues, and those it dropped because a queue was
/// full: all UDP sockets of the network together.
struct UdpQueues {
  std::int64_t waiting_bytes = 0;
  std::int64_t dropped = 0;
};

/// Parses /proc/net/udp. Malformed lines are skipped.
[[nodiscard]] UdpQueues parse_udp_queues(std::istream& table);
[[nodiscard]] UdpQueues read_udp_queues();

}  // namespace nodmap::bench
