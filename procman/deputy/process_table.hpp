// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace nodmap::procman {

/// One line of the system's process table (/proc/PID/stat).
struct ProcessRow {
  pid_t pid = 0;
  pid_t parent = 0;
  pid_t session = 0;
  char state = '?';
  std::uint64_t start_ticks = 0;  ///< since the machine started; with the pid it names a process
  std::uint64_t cpu_ticks = 0;    ///< user and system
  std::int64_t vsize_bytes = 0;
  std::int64_t rss_pages = 0;

  [[nodiscard]] bool is_dead() const { return state == 'Z' || state == 'X'; }
};

/// Reads the text of /proc/PID/stat; nothing where it is not one.
[[nodiscard]] std::optional<ProcessRow> parse_process(std::string_view stat);

[[nodiscard]] std::optional<ProcessRow> read_process(pid_t pid);

/// Every process there is.
[[nodiscard]] std::vector<ProcessRow> read_processes();

/// A variable in the environment that a process was started with; nothing where that cannot be
/// read.
[[nodiscard]] std::optional<std::string> variable_of(pid_t pid, std::string_view name);

/// Whether a process has an environment that can be read: not if it has none, is not ours, or is
/// just being replaced by exec.
[[nodiscard]] bool has_environment(pid_t pid);

/// The living processes among `table` that are a root, or descend from one.
[[nodiscard]] std::vector<pid_t> tree_of(std::span<const ProcessRow> table,
                                         const std::function<bool(const ProcessRow&)>& is_root);

}  // namespace nodmap::procman
