// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <boost/core/noncopyable.hpp>
#include <filesystem>
#include <set>
#include <vector>

namespace nodmap::node {

/// The kernel's unbound worker threads ("kworker/u..."): among other things they carry the bytes
/// that a serial port or pseudo-terminal has received to the program that reads it. In order of
/// creation; empty inside a container, which does not see the kernel's threads.
[[nodiscard]] std::vector<pid_t> serial_workers(const std::filesystem::path& proc = "/proc");

/// Whether this process has the right to change their priority (CAP_SYS_NICE). Changes nothing.
[[nodiscard]] bool may_raise_serial_workers();

/// Puts the kernel's workers above all ordinary processes while it lives.
///
/// They are ordinary processes, so that on a busy machine the bytes of a scan wait for their turn,
/// even if driver and device have real-time priority: up to 39 ms while a browser starts beside six
/// busy loops, 0.4 ms with raised workers (bench/REPORT.md). They get the lowest real-time priority
/// there is: whatever of the robot asks for one still goes first, so that heavy work of the kernel
/// (writing files) cannot delay it.
class SerialWorkers : private boost::noncopyable {
 public:
  /// Gives those that were raised their ordinary priority back.
  ~SerialWorkers();

  /// Raises those that are not. To be called once a second, for the kernel makes new ones as it
  /// needs them. False where it is not permitted.
  bool raise();

 private:
  std::set<pid_t> raised_;
};

}  // namespace nodmap::node
