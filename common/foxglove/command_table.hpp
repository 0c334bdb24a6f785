// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "common/foxglove/foxglove.hpp"
#include "procman_lcm/deputy_info_t.hpp"

namespace nodmap::foxglove {

/// The name of the program an exec line runs, without its folder: what STATUS calls the process.
[[nodiscard]] std::string program_of(const std::string& exec);

/// What the process manager runs, by the newest PM_INFO of each host.
class CommandTable {
 public:
  /// More than any robot of ours has; what is beyond is not taken.
  static constexpr std::size_t kMaxHosts = 16;
  static constexpr std::size_t kMaxCommands = 512;  ///< of a host

  /// A command of the configuration: listed as stopped until its host tells of it.
  struct Known {
    std::string command;
    std::string group;
    std::string host;
    std::string exec;
  };
  void know(std::vector<Known> commands) { known_ = std::move(commands); }

  /// Whether it was taken.
  bool update(const procman_lcm::deputy_info_t& info);
  void clear() { hosts_.clear(); }

  /// {timestamp, hosts: [...], commands: [{command, group, host, process_name, state, pid,
  /// cpu_share, rss_bytes, end}]}; state is "running", "stopped" or "failed", `end` how it failed.
  [[nodiscard]] Json commands() const;

 private:
  std::vector<Known> known_;
  std::map<std::string, procman_lcm::deputy_info_t> hosts_;
};

}  // namespace nodmap::foxglove
