// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/serial_workers.hpp"

#include <sched.h>

#include <cerrno>
#include <fstream>
#include <string>
#include <utility>

#include "common/node/log.hpp"

namespace nodmap::node {
namespace {

namespace fs = std::filesystem;

// The parent of all kernel threads (kthreadd). Only its children are examined, because any program
// may give itself the name of a kernel thread.
constexpr const char* kParent = "2";

std::string first_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

}  // namespace

std::vector<pid_t> serial_workers(const fs::path& proc) {
  std::vector<pid_t> workers;
  if (first_line(proc / kParent / "comm") != "kthreadd") {
    return workers;
  }
  std::ifstream children(proc / kParent / "task" / kParent / "children");
  for (pid_t pid = 0; children >> pid;) {
    if (first_line(proc / std::to_string(pid) / "comm").starts_with("kworker/u")) {
      workers.push_back(pid);
    }
  }
  return workers;
}

bool may_raise_serial_workers() {
  for (const pid_t pid : serial_workers()) {
    // Sets the priority to its present value, which needs the same privilege.
    sched_param same{};
    const int policy = ::sched_getscheduler(pid);
    if (policy >= 0 && ::sched_getparam(pid, &same) == 0) {
      return ::sched_setscheduler(pid, policy, &same) == 0;
    }
  }
  return false;
}

bool SerialWorkers::raise() {
  const sched_param lowest{::sched_get_priority_min(SCHED_FIFO)};
  const std::vector<pid_t> workers = serial_workers();
  for (const pid_t pid : workers) {
    if (::sched_getscheduler(pid) != SCHED_OTHER) {
      continue;  // already raised, or ended
    }
    if (::sched_setscheduler(pid, SCHED_FIFO, &lowest) == 0) {
      raised_.insert(pid);
    } else if (errno == EPERM) {
      return false;
    }
  }
  return !workers.empty();
}

void SerialWorkers::restore() {
  if (raised_.empty()) {
    return;
  }
  const sched_param ordinary{};
  for (const pid_t pid : serial_workers()) {
    if (raised_.contains(pid)) {
      ::sched_setscheduler(pid, SCHED_OTHER, &ordinary);
    }
  }
  raised_.clear();
}

void SerialWorkers::keep_raised(bool wanted) {
  if (!wanted) {
    restore();
  } else if (!raise() && !std::exchange(refused_, true)) {
    log::get().warn(
        "not permitted to raise the priority of the kernel's serial workers (CAP_SYS_NICE): on a "
        "busy machine bytes of serial ports will be late");
  }
}

}  // namespace nodmap::node
