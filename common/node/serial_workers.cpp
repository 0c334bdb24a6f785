// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/serial_workers.hpp"

#include <sched.h>

#include <algorithm>
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

bool is_ordinary(pid_t pid) {
  return ::sched_getscheduler(pid) == SCHED_OTHER;
}

bool make_real_time(pid_t pid) {
  const sched_param lowest{::sched_get_priority_min(SCHED_FIFO)};
  return ::sched_setscheduler(pid, SCHED_FIFO, &lowest) == 0;
}

bool make_ordinary(pid_t pid) {
  const sched_param ordinary{};
  return ::sched_setscheduler(pid, SCHED_OTHER, &ordinary) == 0;
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

bool may_raise_serial_workers(const fs::path& proc) {
  // Setting the priority that a worker already has would prove nothing: root may do so without the
  // right to raise it.
  const std::vector<pid_t> workers = serial_workers(proc);
  const auto ordinary = std::ranges::find_if(workers, is_ordinary);
  if (ordinary == workers.end()) {
    return !workers.empty();  // somebody has raised them all
  }
  return make_real_time(*ordinary) && make_ordinary(*ordinary);
}

bool SerialWorkers::raise() {
  const std::vector<pid_t> workers = serial_workers(proc_);
  for (const pid_t pid : workers) {
    if (!is_ordinary(pid)) {
      continue;  // already raised, or ended
    }
    if (make_real_time(pid)) {
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
  for (const pid_t pid : serial_workers(proc_)) {
    if (raised_.contains(pid)) {
      make_ordinary(pid);
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
