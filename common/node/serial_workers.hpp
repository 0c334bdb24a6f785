// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <boost/core/noncopyable.hpp>
#include <filesystem>
#include <set>
#include <utility>
#include <vector>

namespace nodmap::node {

/// The process ids of the kernel's unbound worker threads ("kworker/u..."), in order of creation.
/// They pass received bytes from a serial port or pseudo-terminal to the program that reads it.
/// Empty inside a container, which does not see kernel threads.
[[nodiscard]] std::vector<pid_t> serial_workers(const std::filesystem::path& proc = "/proc");

/// Whether this process has the right to raise their priority (CAP_SYS_NICE). Tries it on one of
/// them that has ordinary priority, and gives that back at once.
[[nodiscard]] bool may_raise_serial_workers(const std::filesystem::path& proc = "/proc");

/// Gives the kernel's workers priority over all ordinary processes during its lifetime.
///
/// Otherwise they are scheduled as ordinary processes, so that on a busy machine the bytes of a
/// scan are delayed even if driver and device have real-time priority: by up to 39 ms while a
/// browser starts beside six busy loops, and 0.4 ms with raised workers (bench/REPORT.md). They get
/// the lowest real-time priority: the robot's own real-time processes go first, so that heavy work
/// of the kernel (writing files) cannot delay them.
class SerialWorkers : private boost::noncopyable {
 public:
  explicit SerialWorkers(std::filesystem::path proc = "/proc") : proc_(std::move(proc)) {}
  ~SerialWorkers() { restore(); }

  /// Raises the workers that are not raised yet; returns false if that is not permitted.
  bool raise();

  /// Gives those that were raised their ordinary priority back.
  void restore();

  /// Raises them if they are wanted, otherwise restores them; logs once if raising is not
  /// permitted. Call it once a second, because the kernel creates new workers as needed.
  void keep_raised(bool wanted);

 private:
  std::filesystem::path proc_;
  std::set<pid_t> raised_;
  bool refused_ = false;
};

}  // namespace nodmap::node
