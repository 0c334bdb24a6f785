// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "common/node/cpu_load.hpp"
#include "procman/deputy/process_table.hpp"
#include "procman/protocol/values.hpp"

namespace nodmap::procman {

/// The value of a line of /proc/meminfo in bytes; 0 where it is missing.
[[nodiscard]] std::int64_t parse_memory_bytes(std::string_view meminfo, std::string_view name);

/// What the system and the processes use, measured from one sample to the next.
class SystemLoad {
 public:
  /// Takes a sample; to be called once a second. `pids` are the processes to look at.
  void sample(const std::vector<pid_t>& pids);

  /// Fills in the host's figures.
  void describe_host(DeputyInfo& info) const;
  /// Fills in a process's figures; zeros where it is not known (yet).
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
  DeputyInfo memory_;
  std::vector<Usage> usages_;
};

}  // namespace nodmap::procman
