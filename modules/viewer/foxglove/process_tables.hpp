// SPDX-License-Identifier: BSD-3-Clause
// The tables of processes: what they say in STATUS, and what the process manager runs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "modules/viewer/foxglove/foxglove.hpp"
#include "nodmap/status_t.hpp"
#include "procman/config/config.hpp"
#include "procman_lcm/deputy_info_t.hpp"

namespace nodmap::foxglove {

/// The newest STATUS of each process, in the order of their names: one message for all, since a
/// reader may see only the newest message of a topic.
class ProcessTable {
 public:
  /// More processes than any robot of ours has; names beyond are not taken.
  static constexpr std::size_t kMaxProcesses = 64;

  struct Change {
    bool taken = false;
    bool health_changed = false;
  };
  Change update(const nodmap::status_t& status);
  void clear() { processes_.clear(); }

  /// {timestamp, processes: [the fields of a status_t each]}.
  [[nodiscard]] Json processes() const;

 private:
  std::map<std::string, nodmap::status_t> processes_;
};

/// foxglove.Log of what a process says of its health.
[[nodiscard]] Json health_log(const nodmap::status_t& status);

/// What the process manager runs, by the newest PM_INFO of each host.
class CommandTable {
 public:
  /// More than any robot of ours has; what is beyond is not taken.
  static constexpr std::size_t kMaxHosts = 16;
  static constexpr std::size_t kMaxCommands = 512;  ///< of a host

  /// Commands of the configuration are listed as stopped until their host tells of them.
  void set_configured(const procman::Config& config) { configured_ = config.commands; }

  /// Whether it was taken.
  bool update(const procman_lcm::deputy_info_t& info);
  void clear() { hosts_.clear(); }

  /// {timestamp, hosts: [...], commands: [{command, group, host, process_name, state, pid,
  /// cpu_share, rss_bytes, end}]}; state is "running", "stopped" or "failed", `end` how it failed.
  [[nodiscard]] Json commands() const;

 private:
  std::vector<procman::Command> configured_;
  std::map<std::string, procman_lcm::deputy_info_t> hosts_;
};

}  // namespace nodmap::foxglove
