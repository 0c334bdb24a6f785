// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "common/node/cpu_load.hpp"
#include "procman/deputy/process_table.hpp"
#include "procman/protocol/values.hpp"

namespace nodmap::procman {

/// The value of a line of /proc/meminfo in bytes; 0 if it is missing.
[[nodiscard]] std::int64_t parse_memory_bytes(std::string_view meminfo, std::string_view name);

/// Measures the load of the system and of processes between samples.
class SystemLoad {
 public:
  /// Takes a sample; to be called once a second. `pids`: the processes to measure.
  void sample(const std::vector<pid_t>& pids);

  /// Fills in the host's load and memory.
  void describe_host(DeputyInfo& info) const;
  /// Fills in a process's load and memory; zeros if they are unknown.
  void describe_process(CommandStatus& status) const;

 private:
  struct Usage {
    pid_t pid = 0;
    std::uint64_t start_ticks = 0;
    std::uint64_t cpu_ticks = 0;
    float share = 0.0F;
    std::int64_t vsize_bytes = 0;
    std::int64_t rss_bytes = 0;
  };
  [[nodiscard]] const Usage* find(pid_t pid) const;

  node::CpuLoad cpu_;
  Memory memory_;
  std::vector<Usage> usages_;
};

}  // namespace nodmap::procman
