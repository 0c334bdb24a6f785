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
  /// Since the machine started; together with the pid it identifies a process.
  std::uint64_t start_ticks = 0;
  std::uint64_t cpu_ticks = 0;  ///< user and system time
  std::int64_t vsize_bytes = 0;
  std::int64_t rss_pages = 0;

  [[nodiscard]] bool is_dead() const { return state == 'Z' || state == 'X'; }
};

/// Parses the text of /proc/PID/stat; empty if it is invalid.
[[nodiscard]] std::optional<ProcessRow> parse_process(std::string_view stat);

[[nodiscard]] std::optional<ProcessRow> read_process(pid_t pid);

/// All processes of the system.
[[nodiscard]] std::vector<ProcessRow> read_processes();

/// A variable in a process's initial environment; empty if it cannot be read.
[[nodiscard]] std::optional<std::string> variable_of(pid_t pid, std::string_view name);

/// Whether a process's environment can be read: not if it is empty, belongs to another user, or is
/// being replaced by exec.
[[nodiscard]] bool has_environment(pid_t pid);

/// The living processes in `table` that are a root or descend from one.
[[nodiscard]] std::vector<pid_t> tree_of(std::span<const ProcessRow> table,
                                         const std::function<bool(const ProcessRow&)>& is_root);

}  // namespace nodmap::procman
